// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf::sim {

/// While one exists, allocations of the calling thread succeed: they are the simulation's, not the
/// server's (memory_calls.cpp).
class OwnMemory {
 public:
  OwnMemory() noexcept { ++depth; }
  ~OwnMemory() { --depth; }
  OwnMemory(const OwnMemory&) = delete;
  OwnMemory& operator=(const OwnMemory&) = delete;
  static bool is_used() noexcept { return depth > 0; }

 private:
  static inline thread_local int depth = 0;
};

}  // namespace kerf::sim
