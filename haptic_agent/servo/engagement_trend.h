// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace kerf::agent {

/// How strongly the tool is engaged, as a straight line over the way of its tip: a weighted fit to
/// the answers so far, the newest counting most, so that an answer that is one round trip old still
/// tells what is felt where the hand is now.
class EngagementTrend {
 public:
  /// At `way_mm` it was `value` (>= 0); an answer that is this much way older counts half as much
  /// when `forget` is 1/2.
  void take(double way_mm, double value, double forget) noexcept {
    if (weight_ == 0) origin_mm_ = way_mm;
    const double x = way_mm - origin_mm_;
    weight_ = weight_ * forget + 1;
    x_ = x_ * forget + x;
    y_ = y_ * forget + value;
    xx_ = xx_ * forget + x * x;
    xy_ = xy_ * forget + x * value;
    newest_ = value;
  }

  /// What it is at `way_mm`, never farther from the newest answer than half of that.
  double at(double way_mm) const noexcept {
    if (weight_ == 0) return 0;
    const double middle = x_ / weight_;
    const double mean = y_ / weight_;
    const double spread = xx_ / weight_ - middle * middle;
    const double slope = spread > kLeastSpreadMm2 ? (xy_ / weight_ - middle * mean) / spread : 0;
    const double value = mean + slope * (way_mm - origin_mm_ - middle);
    return std::clamp(value, newest_ / 2, newest_ * 3 / 2);
  }

  void reset() noexcept { *this = {}; }
  bool empty() const noexcept { return weight_ == 0; }

 private:
  static constexpr double kLeastSpreadMm2 = 1e-4;

  double origin_mm_ = 0;
  double weight_ = 0, x_ = 0, y_ = 0, xx_ = 0, xy_ = 0;
  double newest_ = 0;
};

}  // namespace kerf::agent
