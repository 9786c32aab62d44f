// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <time.h>

namespace kerf::test {

/// Returns the CPU time of the calling thread, s.
inline double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + double(t.tv_nsec) * 1e-9;
}

}  // namespace kerf::test
