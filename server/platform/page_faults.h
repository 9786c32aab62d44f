// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf {

/// The first access to a page of memory makes the operating system find and clear one. Code that
/// measures a sample counts these accesses apart, because a sample uses memory that earlier ones
/// have freed, and so has fewer of them than the whole.
struct PageFaults {
  static constexpr double kPageBytes = 4096;

  /// Returns the number of such accesses of the calling thread so far.
  static std::int64_t of_thread() noexcept;
  /// Returns the CPU time of one, s, measured now on 1 MB of new memory; 0 if there is none.
  static double cpu_s_each() noexcept;
};

}  // namespace kerf
