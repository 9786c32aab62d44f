// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace kerf::net {

/// The minimum pace of an upload. A slower one ends with a 408, because it holds upload memory.
struct UploadPace {
  std::size_t kilobytes_per_s = 256;  ///< of 1024 bytes; above 0
  std::chrono::seconds time_min{30};  ///< granted to any upload, however short

  /// The time within which an upload of `bytes` bytes must be complete.
  std::chrono::seconds time_for(std::size_t bytes) const {
    return time_min + std::chrono::seconds(bytes / (kilobytes_per_s * 1024));
  }
  /// Explains the limit, as one sentence.
  std::string too_slow() const {
    return "an upload needs " + std::to_string(kilobytes_per_s) + " kB/s after its first " +
           std::to_string(time_min.count()) + " s";
  }
};

}  // namespace kerf::net
