// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <ctime>

namespace kerf::agent {

/// The servo's clock, CLOCK_MONOTONIC, in microseconds: the same instant reads the same on every
/// thread. Neither waits nor allocates.
inline std::uint64_t monotonic_us() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * 1'000'000 +
         static_cast<std::uint64_t>(now.tv_nsec) / 1000;
}

}  // namespace kerf::agent
