// SPDX-License-Identifier: Apache-2.0
// Copies and fills memory in vectors of sixteen bytes. Clang calls memcpy and memset for the
// structures of eight numbers of kernel/math, and those of wasi-libc use words of four bytes.

#include <cstddef>

namespace {

typedef signed char Bytes __attribute__((vector_size(16), aligned(1), may_alias));

}  // namespace

// `no_builtin`: or clang would call the functions for their own loops.
extern "C" __attribute__((no_builtin)) void* memcpy(void* to, const void* from, std::size_t size) {
  auto* out = static_cast<char*>(to);
  const auto* in = static_cast<const char*>(from);
  for (; size >= sizeof(Bytes); size -= sizeof(Bytes)) {
    *reinterpret_cast<Bytes*>(out) = *reinterpret_cast<const Bytes*>(in);
    out += sizeof(Bytes);
    in += sizeof(Bytes);
  }
  for (; size > 0; --size) *out++ = *in++;
  return to;
}

extern "C" __attribute__((no_builtin)) void* memset(void* to, int value, std::size_t size) {
  auto* out = static_cast<char*>(to);
  const auto byte = static_cast<signed char>(value);
  for (; size >= sizeof(Bytes); size -= sizeof(Bytes)) {
    *reinterpret_cast<Bytes*>(out) = Bytes{} + byte;
    out += sizeof(Bytes);
  }
  for (; size > 0; --size) *out++ = byte;
  return to;
}
