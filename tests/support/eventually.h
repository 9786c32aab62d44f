// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <thread>

namespace kerf::test {

/// Factor by which a test may take longer than usual.
#ifdef __SANITIZE_THREAD__
inline constexpr int kPatience = 20;
#else
inline constexpr int kPatience = 1;
#endif

/// Waits until the condition holds. The limit of 20 s only ends a failed test.
template <typename Condition>
bool eventually(Condition condition) {
  for (int i = 0; i < 4000 * kPatience; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

}  // namespace kerf::test
