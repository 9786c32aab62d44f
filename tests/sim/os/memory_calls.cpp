// SPDX-License-Identifier: Apache-2.0
// operator new: large allocations of the threads that work on requests fail by chance while their
// machine lacks memory. Other threads get their memory: an exception there ends the process, which
// is a SIGKILL and a fault of its own.
#include <pthread.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <string_view>

#include "tests/sim/os/own_memory.h"
#include "tests/sim/os/scheduler.h"

namespace kerf::sim {
namespace {

constexpr std::size_t kLargeBytes = 4096;
constexpr double kFailures = 0.2;

bool works_on_requests() noexcept {
  std::array<char, 16> name{};
  pthread_getname_np(pthread_self(), name.data(), name.size());
  constexpr std::array<std::string_view, 5> kNames = {"control", "history", "workers", "readers",
                                                      "exports"};
  return std::ranges::find(kNames, std::string_view(name.data())) != kNames.end();
}

bool fails(std::size_t size) noexcept {
  if (size < kLargeBytes || !takes_turns() || OwnMemory::is_used()) return false;
  const Machine* const machine = this_machine();
  return machine != nullptr && machine->lacks_memory && works_on_requests() && happens(kFailures);
}

}  // namespace
}  // namespace kerf::sim

// The other forms of new call these. The library's delete frees the memory that malloc returns.
void* operator new(std::size_t size) {
  if (kerf::sim::fails(size)) throw std::bad_alloc();
  if (void* memory = std::malloc(std::max<std::size_t>(size, 1))) return memory;
  throw std::bad_alloc();
}

void* operator new(std::size_t size, std::align_val_t alignment) {
  if (kerf::sim::fails(size)) throw std::bad_alloc();
  const auto bytes = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(bytes, (size + bytes - 1) / bytes * bytes)) return memory;
  throw std::bad_alloc();
}
