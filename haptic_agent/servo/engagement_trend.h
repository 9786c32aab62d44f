// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace kerf::agent {

/// Weighted linear fit of the tool's engagement over the path length of its tip. The newest answers
/// have the greatest weight. The fit extrapolates answers that are a round trip old to the current
/// position.
class EngagementTrend {
 public:
  /// Adds `value` (>= 0) at `path_mm`. The weights of all earlier answers are multiplied by
  /// `forget` (0..1).
  void take(double path_mm, double value, double forget) noexcept {
    if (weight_ == 0) origin_mm_ = path_mm;
    const double x = path_mm - origin_mm_;
    weight_ = weight_ * forget + 1;
    x_ = x_ * forget + x;
    y_ = y_ * forget + value;
    xx_ = xx_ * forget + x * x;
    xy_ = xy_ * forget + x * value;
    newest_ = value;
  }

  /// Returns the fit at `path_mm`, clamped to within half of the newest answer.
  double at(double path_mm) const noexcept {
    if (weight_ == 0) return 0;
    const double middle = x_ / weight_;
    const double mean = y_ / weight_;
    const double spread = xx_ / weight_ - middle * middle;
    const double slope = spread > kMinSpreadMm2 ? (xy_ / weight_ - middle * mean) / spread : 0;
    const double value = mean + slope * (path_mm - origin_mm_ - middle);
    return std::clamp(value, newest_ / 2, newest_ * 3 / 2);
  }

  void reset() noexcept { *this = {}; }
  bool empty() const noexcept { return weight_ == 0; }

 private:
  static constexpr double kMinSpreadMm2 = 1e-4;

  double origin_mm_ = 0;
  double weight_ = 0, x_ = 0, y_ = 0, xx_ = 0, xy_ = 0;
  double newest_ = 0;
};

}  // namespace kerf::agent
