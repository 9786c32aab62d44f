// SPDX-License-Identifier: Apache-2.0
// Exceptions for WebAssembly. The readers throw and catch; browsers unwind the stack, but Debian's
// libc++abi for WASI was built without what the compiler calls then: these functions of the Itanium
// C++ ABI, and the search of a function's table for the handler (as libc++abi's
// cxa_personality.cpp and libunwind's Unwind-wasm.c document its format). One thread; no rethrow.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <typeinfo>

namespace __cxxabiv1 {

/// What libc++abi's type informations derive from; the order of the virtual functions is its.
class __shim_type_info : public std::type_info {
 public:
  ~__shim_type_info() override;
  virtual void noop1() const;
  virtual void noop2() const;
  virtual bool can_catch(const __shim_type_info* thrown, void*& object) const = 0;
};

}  // namespace __cxxabiv1

namespace {

using TypeInfo = __cxxabiv1::__shim_type_info;

/// Before each thrown object.
struct Thrown {
  const TypeInfo* type;
  void* (*destroy)(void*);  ///< a destructor returns its object here
  void* caught;             ///< the object as its handler's type
  Thrown* below;            ///< whose handler was entered before
};
constexpr std::size_t kHeadBytes = (sizeof(Thrown) + 15) / 16 * 16;

Thrown* g_caught = nullptr;

Thrown* head_of(void* object) {
  return reinterpret_cast<Thrown*>(static_cast<std::byte*>(object) - kHeadBytes);
}

void* object_of(Thrown* thrown) { return reinterpret_cast<std::byte*>(thrown) + kHeadBytes; }

/// Reads the numbers of a function's table.
struct Table {
  const std::uint8_t* at;

  std::uint32_t unsigned_number() {
    std::uint32_t value = 0;
    for (unsigned shift = 0;; shift += 7) {
      const std::uint8_t byte = *at++;
      value |= (byte & 0x7fU) << shift;
      if (byte < 0x80) return value;
    }
  }

  std::int32_t signed_number() {
    std::uint32_t value = 0;
    unsigned shift = 0;
    std::uint8_t byte = 0;
    do {
      byte = *at++;
      value |= (byte & 0x7fU) << shift;
      shift += 7;
    } while (byte >= 0x80);
    if (shift < 32 && (byte & 0x40) != 0) value |= ~std::uint32_t{0} << shift;
    return static_cast<std::int32_t>(value);
  }
};

constexpr std::uint8_t kOmitted = 0xff;  // DW_EH_PE_omit

/// A function's table: its handlers' types, and for each landing pad a chain of actions.
struct Handlers {
  const std::uint8_t* types = nullptr;  ///< behind the last one; the first stands at the end
  const std::uint8_t* actions = nullptr;
  std::uint32_t action = 0;  ///< of the landing pad, from 1; 0: none

  Handlers(const std::uint8_t* table, std::uint32_t pad) {
    Table in{table};
    if (*in.at++ != kOmitted) std::abort();  // where landing pads begin; WebAssembly has no such
    if (*in.at++ != kOmitted) {
      const std::uint32_t length = in.unsigned_number();
      types = in.at + length;
    }
    ++in.at;  // the encoding of the following, which is fixed
    const std::uint32_t bytes = in.unsigned_number();
    actions = in.at + bytes;
    while (in.at < actions) {
      const std::uint32_t index = in.unsigned_number();
      const std::uint32_t first = in.unsigned_number();
      if (index == pad) action = first;
    }
  }

  const TypeInfo* type(std::int32_t number) const {
    const TypeInfo* found = nullptr;
    std::memcpy(&found, types - sizeof found * static_cast<std::size_t>(number), sizeof found);
    return found;
  }
};

/// Returns the number of the type that catches the object, from 1; 0: none.
std::uint32_t handler_of(const std::uint8_t* table, std::uint32_t pad, Thrown& thrown) {
  const Handlers handlers(table, pad);
  if (handlers.action == 0) return 0;
  Table in{handlers.actions + handlers.action - 1};
  while (true) {
    const std::int32_t number = in.signed_number();
    const std::uint8_t* next = in.at;
    if (number > 0) {
      const TypeInfo* type = handlers.type(number);
      void* object = object_of(&thrown);
      if (type == nullptr || type->can_catch(thrown.type, object)) {
        thrown.caught = object;
        return static_cast<std::uint32_t>(number);
      }
    }
    const std::int32_t distance = in.signed_number();
    if (distance == 0) return 0;
    in.at = next + distance;
  }
}

}  // namespace

extern "C" {

/// What the compiler's code and the search exchange.
struct LandingPad {
  std::uintptr_t pad;
  const std::uint8_t* table;
  std::uintptr_t selector;
};
thread_local LandingPad __wasm_lpad_context;

/// Called where an exception arrives at code that catches some types.
int _Unwind_CallPersonality(void* object) {
  __wasm_lpad_context.selector = 0;
  if (__wasm_lpad_context.table != nullptr)
    __wasm_lpad_context.selector =
        handler_of(__wasm_lpad_context.table, static_cast<std::uint32_t>(__wasm_lpad_context.pad),
                   *head_of(object));
  return 0;
}

void* __cxa_allocate_exception(std::size_t bytes) noexcept {
  auto* memory = static_cast<std::byte*>(std::malloc(kHeadBytes + bytes));
  if (memory == nullptr) std::abort();
  return memory + kHeadBytes;
}

void __cxa_free_exception(void* object) noexcept { std::free(head_of(object)); }

[[noreturn]] void __cxa_throw(void* object, std::type_info* type, void* (*destroy)(void*)) {
  *head_of(object) = {static_cast<const TypeInfo*>(type), destroy, object, nullptr};
  __builtin_wasm_throw(0, object);
}

void* __cxa_begin_catch(void* object) noexcept {
  Thrown* thrown = head_of(object);
  thrown->below = g_caught;
  g_caught = thrown;
  return thrown->caught;
}

void __cxa_end_catch() {
  Thrown* thrown = g_caught;
  g_caught = thrown->below;
  void* object = object_of(thrown);
  if (thrown->destroy != nullptr) thrown->destroy(object);
  __cxa_free_exception(object);
}

}  // extern "C"
