// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf::test {

/// Makes one allocation of the process fail: `operator new` throws std::bad_alloc at the k-th call
/// after the construction, on any thread. Only one may exist at a time.
class FailingMemory {
 public:
  explicit FailingMemory(std::uint64_t k);
  FailingMemory(const FailingMemory&) = delete;
  FailingMemory& operator=(const FailingMemory&) = delete;
  ~FailingMemory();
  /// Returns the number of allocations before the one that fails, or 0 after it.
  std::uint64_t left() const;
};

}  // namespace kerf::test
