// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace kerf::agent {

/// Estimates one coordinate of a pose between the steps of its encoder.
///
/// When the measured value steps, the true one is midway between the two values, at some time since
/// the last measurement: a step is the only exact measurement of an encoder. A line is fitted to
/// the newest collinear steps and continued until the next step, within the cell whose value the
/// encoder shows. So the estimate has no delay in steady motion, after two steps, and is never more
/// than a cell off.
class StepTracker {
 public:
  /// `quantum`: size of the encoder's steps, in the coordinate's unit, or 0 if unknown. An unknown
  /// quantum is the median of the steps that follow rests, once kStepsOfEncoder of them occurred
  /// within kDetectS. Until then the estimate is the measured value.
  explicit StepTracker(double quantum = 0) noexcept : declared_(quantum) {}

  /// Adds the value measured `dt_s` after the last one. Returns the estimate for the present time.
  /// `is_new`: the device has measured since; otherwise a repeated value carries no information.
  double take(double measured, double dt_s, bool is_new = true) noexcept;
  /// Forgets the motion, but not the quantum. The next estimate is the measured value.
  void reset() noexcept;
  /// Rate of the estimate, per second.
  double rate() const noexcept { return rate_; }
  /// Size of the encoder's steps, as declared or found, or 0 if not found yet.
  double quantum() const noexcept { return declared_ > 0 ? declared_ : found_; }

  static constexpr std::size_t kStepsOfEncoder = 4;
  static constexpr double kDetectS = 0.5;

 private:
  /// The true value is `at` at the time `s`.
  struct Step {
    double s, at, size;
    bool rested;  ///< the previous measurement had not changed the value
  };
  static constexpr std::size_t kKept = 64;

  const Step& newest(std::size_t back) const noexcept {
    return steps_[(count_ + kKept - 1 - back) % kKept];
  }
  std::size_t kept() const noexcept { return count_ < kKept ? count_ : kKept; }
  void step_to(double measured, double dt_s) noexcept;
  void find_quantum() noexcept;
  void fit(double dt_s) noexcept;
  bool is_line(std::size_t steps, double dt_s) const noexcept;
  std::size_t explained(double dt_s) const noexcept;

  double declared_, found_ = 0;
  std::array<Step, kKept> steps_{};
  std::size_t count_ = 0;
  double now_s_ = 0;
  double measured_ = 0, estimate_ = 0, rate_ = 0;
  /// The fitted line: its value at the newest step, and its slope.
  double line_ = 0, slope_ = 0;
  bool has_value_ = false, rested_ = true;
};

}  // namespace kerf::agent
