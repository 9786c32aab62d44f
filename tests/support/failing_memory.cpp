// SPDX-License-Identifier: Apache-2.0
#include "tests/support/failing_memory.h"

#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace kerf::test {
namespace {

/// Number of allocations until the one that fails, which sets it to 0. Negative if none fails.
std::atomic<std::int64_t> until_failure{-1};

std::atomic<std::uint64_t> bytes_now{0}, bytes_most{0};

bool fails() {
  return until_failure.load(std::memory_order_relaxed) > 0 && until_failure.fetch_sub(1) == 1;
}

void* counted(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  const std::uint64_t now = bytes_now += malloc_usable_size(memory);
  std::uint64_t most = bytes_most.load(std::memory_order_relaxed);
  while (now > most && !bytes_most.compare_exchange_weak(most, now)) {
  }
  return memory;
}

void release(void* memory) {
  bytes_now -= malloc_usable_size(memory);
  std::free(memory);
}

}  // namespace

FailingMemory::FailingMemory(std::uint64_t k) { until_failure = static_cast<std::int64_t>(k); }
FailingMemory::~FailingMemory() { until_failure = -1; }
std::uint64_t FailingMemory::left() const {
  return static_cast<std::uint64_t>(std::max(std::int64_t{0}, until_failure.load()));
}

std::uint64_t allocated_bytes() { return bytes_now; }

PeakMemory::PeakMemory() { bytes_most = bytes_now.load(); }
std::uint64_t PeakMemory::bytes() const { return bytes_most; }

}  // namespace kerf::test

// The other forms of new and delete call these.
void* operator new(std::size_t size) {
  if (kerf::test::fails()) throw std::bad_alloc();
  return kerf::test::counted(std::malloc(std::max<std::size_t>(size, 1)));
}

void* operator new(std::size_t size, std::align_val_t alignment) {
  if (kerf::test::fails()) throw std::bad_alloc();
  const auto bytes = static_cast<std::size_t>(alignment);
  return kerf::test::counted(std::aligned_alloc(bytes, (size + bytes - 1) / bytes * bytes));
}

void operator delete(void* memory) noexcept { kerf::test::release(memory); }
void operator delete(void* memory, std::size_t) noexcept { kerf::test::release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { kerf::test::release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  kerf::test::release(memory);
}
