// SPDX-License-Identifier: Apache-2.0
#include "tests/support/failing_memory.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace kerf::test {
namespace {

/// Number of allocations until the one that fails, which sets it to 0. Negative if none fails.
std::atomic<std::int64_t> until_failure{-1};

bool fails() {
  return until_failure.load(std::memory_order_relaxed) > 0 && until_failure.fetch_sub(1) == 1;
}

}  // namespace

FailingMemory::FailingMemory(std::uint64_t k) { until_failure = static_cast<std::int64_t>(k); }
FailingMemory::~FailingMemory() { until_failure = -1; }
std::uint64_t FailingMemory::left() const {
  return static_cast<std::uint64_t>(std::max(std::int64_t{0}, until_failure.load()));
}

}  // namespace kerf::test

// The other forms of new call these. The library's delete frees memory that malloc returns.
void* operator new(std::size_t size) {
  if (kerf::test::fails()) throw std::bad_alloc();
  if (void* memory = std::malloc(std::max<std::size_t>(size, 1))) return memory;
  throw std::bad_alloc();
}

void* operator new(std::size_t size, std::align_val_t alignment) {
  if (kerf::test::fails()) throw std::bad_alloc();
  const auto bytes = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(bytes, (size + bytes - 1) / bytes * bytes)) return memory;
  throw std::bad_alloc();
}
