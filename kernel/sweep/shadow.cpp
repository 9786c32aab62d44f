// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/shadow.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "kernel/math/tolerance.h"
#include "kernel/piece/bounds.h"

namespace kerf {
namespace {

constexpr double kCos1 = 0.92387953251128674, kCos2 = 0.70710678118654752;
constexpr double kCos3 = 0.38268343236508977;

KERF_INLINE Lanes directions_x() {
  return {HalfLanes{1, kCos1, kCos2, kCos3}, HalfLanes{0, -kCos3, -kCos2, -kCos1}};
}
KERF_INLINE Lanes directions_y() {
  return {HalfLanes{0, kCos3, kCos2, kCos1}, HalfLanes{1, kCos1, kCos2, kCos3}};
}

KERF_INLINE void extend_support_in_lanes(const Vec3& center, const Vec3& axis, double radius,
                                         Lanes& lo, Lanes& hi) {
  const Lanes nx = directions_x(), ny = directions_y();
  const Lanes at = nx * center.x + ny * center.y;
  const Lanes c = nx * axis.x + ny * axis.y;
  const Lanes half = square_root(greater(1.0 - c * c, Lanes(0))) * radius;
  lo = lesser(at - half, lo);
  hi = greater(at + half, hi);
}
KERF_FOR_EACH_TARGET(void, extend_support,
                     (const Vec3& center, const Vec3& axis, double radius, Lanes& lo, Lanes& hi),
                     (center, axis, radius, lo, hi))

KERF_INLINE void bound_discs_in_lanes(const Discs& d, const Lanes& support_lo,
                                      const Lanes& support_hi, double lowest, double at_origin,
                                      double by_x, double by_y, double steepness, Lanes& z) {
  const Lanes nx = directions_x(), ny = directions_y();
  LaneMask reached = d.x_mm == d.x_mm;
  for (int i = 0; i < kLanes; ++i) {
    const Lanes at = d.x_mm * nx[i] + d.y_mm * ny[i];
    reached &= (at + d.reach_mm >= support_lo[i]) & (at - d.reach_mm <= support_hi[i]);
  }
  const Lanes on_plane = at_origin + d.x_mm * by_x + d.y_mm * by_y - steepness * d.reach_mm;
  const Lanes none = std::numeric_limits<double>::infinity();
  z = select(reached, greater(on_plane, Lanes(lowest)), none);
}
KERF_FOR_EACH_TARGET(void, bound_discs,
                     (const Discs& d, const Lanes& support_lo, const Lanes& support_hi,
                      double lowest, double at_origin, double by_x, double by_y, double steepness,
                      Lanes& z),
                     (d, support_lo, support_hi, lowest, at_origin, by_x, by_y, steepness, z))

KERF_INLINE void keep_lower_in_lanes(const Lanes& a, Lanes& b) { b = lesser(a, b); }
KERF_FOR_EACH_TARGET(void, keep_lower, (const Lanes& a, Lanes& b), (a, b))

}  // namespace

Shadow::Shadow(const ToolPiece& slice, const std::vector<ToolPose>& poses, double margin_mm)
    : underside_(slice, poses.front(), poses.back()),
      level_(LevelBound::make(slice, poses.front(), poses.back())) {
  const FrustumPiece e = enclosing_frustum(slice);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  support_lo_ = Lanes(kInfinity);
  support_hi_ = Lanes(-kInfinity);
  bounds_ = {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  const auto each_disc = [&](auto visit) {
    for (const ToolPose& pose : poses) {
      visit(pose.tip_mm + pose.axis * e.z0_mm, pose.axis, e.r0_mm);
      visit(pose.tip_mm + pose.axis * e.z1_mm, pose.axis, e.r1_mm);
    }
  };
  each_disc([&](Vec3 c, Vec3 u, double r) {
    extend_support(c, u, r, support_lo_, support_hi_);
    const Vec3 h = disc_half_widths(r, u) + Vec3{margin_mm, margin_mm, margin_mm};
    bounds_.min_mm = {std::min(bounds_.min_mm.x, c.x - h.x), std::min(bounds_.min_mm.y, c.y - h.y),
                      std::min(bounds_.min_mm.z, c.z - h.z)};
    bounds_.max_mm = {std::max(bounds_.max_mm.x, c.x + h.x), std::max(bounds_.max_mm.y, c.y + h.y),
                      std::max(bounds_.max_mm.z, c.z + h.z)};
  });
  support_lo_ = support_lo_ - margin_mm;
  support_hi_ = support_hi_ + margin_mm;

  plane_ = {-kInfinity, 0, 0, 0};
  const Vec3 u = normalized(poses.front().axis + poses.back().axis);
  const double lean2 = u.x * u.x + u.y * u.y;
  if (!(lean2 > kPlaneLean2 && u.z > 0)) return;
  // The plane parallel to the middle axis that touches the piece from below: n is the upward normal
  // of the axis. Discs reach at most their radius below their centers along n; using the whole
  // radius covers the turn of the axis to either side.
  const double lean = std::sqrt(lean2);
  const Vec3 n{-u.x * u.z / lean, -u.y * u.z / lean, lean};
  double support = kInfinity;
  each_disc([&](Vec3 c, Vec3, double r) { support = std::min(support, dot(n, c) - r); });
  plane_ = {(support - margin_mm) / n.z, -n.x / n.z, -n.y / n.z, u.z / lean};
}

void Shadow::set_trail(const Trail& trail) {
  trail_ = trail;
  if (level_) level_->set_start_is_cut();
}

LeftOut Shadow::lower_bound(const Discs& discs, Lanes& z_mm) const {
  if (level_) return {.gone = level_->lower_bound(discs, z_mm)};
  const Lanes none = Lanes(std::numeric_limits<double>::infinity());
  Lanes z;
  bound_discs(discs, support_lo_, support_hi_, bounds_.min_mm.z, plane_.at_origin_mm, plane_.by_x,
              plane_.by_y, plane_.steepness, z);
  const unsigned reached = lanes_below(z, none);
  if (reached == 0) return {};
  underside_.raise(discs, z);
  LeftOut left_out;
  if (trail_) {
    const Trail::Receding receding = trail_->receding(discs);
    left_out = {.behind = receding.all & reached, .shown_behind = receding.shown & reached};
  }
  for (unsigned left = left_out.behind; left != 0; left &= left - 1) {
    z.set(std::countr_zero(left), std::numeric_limits<double>::infinity());
  }
  keep_lower(z, z_mm);
  return left_out;
}

}  // namespace kerf
