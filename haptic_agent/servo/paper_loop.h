// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/math/wrench.h"

namespace kerf::agent {

/// The haptic cycle of Zhu & Lee 2004, section 4: a force and torque every 10 ms (100 Hz),
/// interpolated linearly from the previous to the newest and output every 1 ms.
///
/// The paper's force is that of the stock removed in one update of 10 ms (Eq. 18). Here the force
/// of an update is the mean of the answers of 1 ms each, which is equal under the removal-rate law.
/// The output reaches it 10 ms after the update, so a steadily changing force is shown as the mean
/// of the last update, one update late.
class PaperLoop {
 public:
  /// Time of an update, and of an interpolation.
  static constexpr std::uint64_t kUpdateUs = 10'000;

  /// Adds an answer to the current update.
  void take(const Wrench& answer) noexcept {
    sum_ = sum_ + answer;
    ++answers_;
  }

  /// Returns the wrench to output in this tick, or zero until the first update is over. Times must
  /// not decrease. An update without an answer repeats the last one.
  Wrench at(std::uint64_t now_us) noexcept {
    // A tick that wakes slightly early still ends the update that is due.
    constexpr std::uint64_t kHalfTickUs = 500;
    if (due_us_ == 0) due_us_ = now_us + kUpdateUs;
    if (now_us + kHalfTickUs >= due_us_) {
      from_ = output(now_us);
      if (answers_ > 0) to_ = sum_ * (1.0 / static_cast<double>(answers_));
      sum_ = {};
      answers_ = 0;
      start_us_ = now_us >= due_us_ + kUpdateUs ? now_us : due_us_;
      due_us_ = start_us_ + kUpdateUs;
    }
    return output(now_us);
  }

 private:
  Wrench output(std::uint64_t now_us) const noexcept {
    const std::uint64_t passed_us = now_us > start_us_ ? now_us - start_us_ : 0;
    if (passed_us >= kUpdateUs) return to_;
    const double part = static_cast<double>(passed_us) / static_cast<double>(kUpdateUs);
    return from_ + (to_ - from_) * part;
  }

  Wrench from_{}, to_{};
  Wrench sum_{};
  std::uint64_t answers_ = 0;
  std::uint64_t start_us_ = 0, due_us_ = 0;
};

}  // namespace kerf::agent
