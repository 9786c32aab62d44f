// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/step_tracker.h"

#include <algorithm>
#include <cmath>

namespace kerf::agent {
namespace {

/// Longest time over which a line is fitted, s. A hand does not move evenly for longer.
constexpr double kLongestFitS = 0.4;
/// Distance from the line at which a step ends it, in quanta and in ticks of travel: a step is
/// timed to within half a tick.
constexpr double kOffQuanta = 0.1;
constexpr double kOffTicks = 1.5;
/// Time constant with which the estimate follows a new line, s.
constexpr double kFollowS = 0.004;

}  // namespace

void StepTracker::reset() noexcept {
  count_ = 0;
  has_value_ = false;
  rested_ = true;
  rate_ = slope_ = 0;
}

/// An encoder rests between its steps. A continuous value rests only where the device does. A
/// coordinate moved by several encoders has steps of different size, so the median counts.
void StepTracker::find_quantum() noexcept {
  if (declared_ > 0 || !newest(0).rested) return;
  std::array<double, kKept> sizes{};
  std::size_t rests = 0;
  for (std::size_t i = 0; i < kept() && now_s_ - newest(i).s <= kDetectS; ++i) {
    if (newest(i).rested) sizes[rests++] = std::abs(newest(i).size);
  }
  if (rests < kStepsOfEncoder) return;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(rests / 2);
  std::nth_element(sizes.begin(), middle, sizes.begin() + static_cast<std::ptrdiff_t>(rests));
  found_ = *middle;
}

/// Returns whether one line explains the newest step and `steps` before it.
bool StepTracker::is_line(std::size_t steps, double dt_s) const noexcept {
  const Step &last = newest(0), &first = newest(steps);
  const double slope = (last.at - first.at) / (last.s - first.s);
  const double off = kOffQuanta * quantum() + kOffTicks * dt_s * std::abs(slope);
  for (std::size_t i = 1; i < steps; ++i) {
    const double line = last.at - slope * (last.s - newest(i).s);
    if (std::abs(newest(i).at - line) > off) return false;
  }
  return true;
}

/// Returns how many of the steps before the newest are on one line with it. Each attempt adds half
/// as many, so that a tick costs little.
std::size_t StepTracker::explained(double dt_s) const noexcept {
  std::size_t most = 0;
  for (std::size_t n = 1; n < kept(); n += std::max<std::size_t>(1, n / 2)) {
    if (n > 1 && newest(0).s - newest(n).s > kLongestFitS) break;
    if (!is_line(n, dt_s)) break;
    most = n;
  }
  return most;
}

/// Fits a line to the newest steps by least squares.
void StepTracker::fit(double dt_s) noexcept {
  const std::size_t steps = explained(dt_s) + 1;
  double s = 0, at = 0;
  for (std::size_t i = 0; i < steps; ++i) s += newest(i).s, at += newest(i).at;
  s /= static_cast<double>(steps), at /= static_cast<double>(steps);
  double ss = 0, sx = 0;
  for (std::size_t i = 0; i < steps; ++i) {
    const double d = newest(i).s - s;
    ss += d * d;
    sx += d * (newest(i).at - at);
  }
  slope_ = ss > 0 ? sx / ss : 0;
  line_ = at + slope_ * (newest(0).s - s);
}

void StepTracker::step_to(double measured, double dt_s) noexcept {
  const double size = measured - measured_;
  steps_[count_++ % kKept] = {now_s_ - dt_s / 2, measured_ + size / 2, size, rested_};
  if (count_ >= 2 * kKept) count_ -= kKept;
  measured_ = measured;
  find_quantum();
  if (quantum() > 0) fit(dt_s);
}

double StepTracker::take(double measured, double dt_s, bool is_new) noexcept {
  if (!has_value_) {
    has_value_ = true;
    now_s_ = 0;
    measured_ = estimate_ = measured;
    return estimate_;
  }
  now_s_ += dt_s;
  const bool stepped = measured != measured_;
  if (stepped) step_to(measured, dt_s);
  if (stepped || is_new) rested_ = !stepped;
  const double before = estimate_;
  if (!(quantum() > 0)) {
    estimate_ = measured;
  } else if (kept() > 0) {
    const double low = measured - quantum() / 2, high = measured + quantum() / 2;
    const double goal = std::clamp(line_ + slope_ * (now_s_ - newest(0).s), low, high);
    const double ahead = estimate_ + slope_ * dt_s;
    const double followed = ahead + (goal - ahead) * (1 - std::exp(-dt_s / kFollowS));
    estimate_ = std::clamp(followed, low, high);
  }
  if (dt_s > 0) rate_ = (estimate_ - before) / dt_s;
  return estimate_;
}

}  // namespace kerf::agent
