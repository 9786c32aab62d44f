// SPDX-License-Identifier: Apache-2.0
#include "kernel/intersect/ray_contour.h"

#include <algorithm>
#include <cmath>

#include "kernel/math/tolerance.h"

namespace kerf {

RayContour::RayContour(const ArcPiece& piece, Vec3 tip_mm, Vec3 unit_axis, Vec3 displacement_mm)
    : center_(tip_mm + unit_axis * piece.center_z_mm),
      axis_(unit_axis),
      d_(displacement_mm),
      center_r_(piece.center_r_mm),
      radius_(piece.radius_mm),
      low_((piece.z0_mm - piece.center_z_mm) / piece.radius_mm),
      high_((piece.z1_mm - piece.center_z_mm) / piece.radius_mm),
      branches_{{-1, {}}, {1, {}}} {
  const double level2 = d_.x * d_.x + d_.y * d_.y, travel2 = dot(d_, d_);
  // A motion along the rays has no contour that bounds them.
  if (!(level2 > kAlongRays2 * travel2)) return;
  exists_ = true;
  const double level = std::sqrt(level2);
  b_ = {-d_.y / level, d_.x / level, 0};
  a_ = cross(d_, b_) * (1 / std::sqrt(travel2));
  const double ub = dot(axis_, b_), ua = dot(axis_, a_);
  steepness_ = std::sqrt(ub * ub + ua * ua);
  flat2_ = std::max(0.0, 1 - (ub * ub + ua * ua));
  along_b_ = steepness_ > 0 ? ub / steepness_ : 1;
  along_a_ = steepness_ > 0 ? ua / steepness_ : 0;
  across_b_ = along_a_;
  across_a_ = -along_b_;
  a_along_d_ = a_.x * d_.x + a_.y * d_.y;
  u_along_d_ = axis_.x * d_.x + axis_.y * d_.y;
  inverse_d2_ = 1 / level2;
  slack_ = kEdgeEpsilonMm / std::sqrt(travel2);
  for (Branch& branch : branches_) {
    branch.flanks[0] = flank(branch.up, 1);
    branch.flanks[1] = flank(branch.up, -1);
  }
}

/// With n = side cos β t + sin β û, û along the projected axis and t across it, the slice is low ≤
/// U sin β ≤ high (in radii), and the upper ends are n·a > 0. The sign changes at one β.
RayContour::Flank RayContour::flank(double up, double side) const {
  const auto sine_at = [&](double height) {
    return height >= steepness_ ? 1.0 : height <= -steepness_ ? -1.0 : height / steepness_;
  };
  double sine0 = sine_at(low_), sine1 = sine_at(high_);
  if (low_ >= steepness_ || high_ <= -steepness_) return {};
  if (along_a_ == 0) return side * across_a_ * up > 0 ? between(side, sine0, sine1) : Flank{};
  const double level = (along_a_ > 0 ? -1 : 1) * side * across_a_;
  (up * along_a_ > 0 ? sine0 : sine1) =
      up * along_a_ > 0 ? std::max(sine0, level) : std::min(sine1, level);
  return between(side, sine0, sine1);
}

RayContour::Flank RayContour::between(double side, double sine0, double sine1) const {
  if (!(sine0 < sine1)) return {};
  double q[2], y[2], margin[2];
  int i = 0;
  for (const double exact : {sine0, sine1}) {
    // If the axis is perpendicular to d, the contour has no tangent at its poles.
    const double sine = std::clamp(exact, -kPoleSine, kPoleSine);
    const double cosine = side * std::sqrt((1 - sine) * (1 + sine));
    const double inverse = 1 / std::sqrt(cosine * cosine + flat2_ * sine * sine);
    q[i] = cosine * across_b_ + sine * along_b_;
    y[i] = center_r_ * (cosine * across_b_ + flat2_ * sine * along_b_) * inverse + radius_ * q[i];
    margin[i++] = sine == exact ? kEdgeEpsilonMm : kPoleMarginMm;
  }
  const int lower = y[0] <= y[1] ? 0 : 1, upper = 1 - lower;
  return {
      q[lower], q[upper], y[lower], y[upper], y[lower] - margin[lower], y[upper] + margin[upper]};
}

}  // namespace kerf
