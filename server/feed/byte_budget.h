// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace kerf {

/// Token bucket for the bytes sent to one viewer. A frame may leave while bytes are left, and may
/// exceed them. So over any time t at most rate · (t + kBurst + kStep) bytes leave, plus the excess
/// of the last frame, which ends with the tile that uses up the rest.
///
/// It is filled in steps of the clock that are the same for all buckets: viewers with the same
/// budget that wait get their bytes at the same moment, and share frames.
class ByteBudget {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::milliseconds kStep{50}, kBurst{500};

  /// Begins empty, so that a viewer that reconnects repeatedly does not get a burst each time.
  explicit ByteBudget(std::uint32_t bytes_per_s) : rate_(bytes_per_s) {}

  void set_bytes_per_s(std::uint32_t bytes_per_s) {
    rate_ = bytes_per_s;
    left_ = std::min(left_, bytes_of(kBurst));
  }
  /// Adds the bytes due until `now`, which never decreases.
  void fill(Time now) {
    const std::int64_t step = now.time_since_epoch() / kStep;
    if (has_begun_) left_ = std::min(bytes_of(kBurst), left_ + (step - step_) * bytes_of(kStep));
    step_ = step;
    has_begun_ = true;
  }
  void take(std::size_t bytes) { left_ -= static_cast<std::int64_t>(bytes); }
  /// Bytes that may leave now.
  std::size_t left() const { return static_cast<std::size_t>(std::max<std::int64_t>(left_, 0)); }
  /// Bytes above half of the burst, for deferrable tiles.
  std::size_t left_to_spare() const {
    return static_cast<std::size_t>(std::max<std::int64_t>(left_ - bytes_of(kBurst) / 2, 0));
  }

 private:
  std::int64_t bytes_of(std::chrono::milliseconds time) const {
    return std::int64_t{rate_} * time.count() / 1000;
  }

  std::int64_t rate_;
  std::int64_t left_ = 0;  ///< negative after a frame that exceeded it
  std::int64_t step_ = 0;
  bool has_begun_ = false;
};

}  // namespace kerf
