// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/level_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Returns a lower bound of the heights at which the slice is at least as wide as `off`.
KERF_INLINE Lanes height_at(const LevelBound::Parameters& b, Lanes off) {
  if (!b.is_arc) return b.lowest + greater(off - b.lower_radius, Lanes(0)) * b.by_slope;
  const Lanes across = greater(off - b.center_r, Lanes(0));
  const Lanes below = square_root(greater(b.arc_radius * b.arc_radius - across * across, Lanes(0)));
  return greater(b.center_z - below, Lanes(b.lowest));
}

KERF_INLINE unsigned bound_level_in_lanes(const LevelBound::Parameters& b, const Discs& discs,
                                          Lanes& z) {
  const double reach = discs.reach_mm + kEdgeEpsilonMm;
  const Lanes px = discs.x_mm - b.x, py = discs.y_mm - b.y;
  const Lanes along = px * b.dir_x + py * b.dir_y;
  const Lanes s = lesser(greater(along, Lanes(0)), Lanes(b.travel));
  const Lanes ex = px - s * b.dir_x, ey = py - s * b.dir_y;
  const Lanes off = greater(square_root(ex * ex + ey * ey) - reach, Lanes(0));
  LaneMask changed = off <= b.radius;
  unsigned inside = 0;
  if (b.start_is_cut) {
    // Behind the first axis no pose is nearer than the first; the last is farther by more than
    // rounding.
    changed &= along >= -(reach + b.behind);
    const double inner = b.inner_radius - reach - kEdgeEpsilonMm;
    if (inner > 0) inside = bits(px * px + py * py < inner * inner);
  }
  const Lanes none = std::numeric_limits<double>::infinity();
  z = lesser(select(changed, height_at(b, off) - kEdgeEpsilonMm, none), z);
  return inside;
}
KERF_FOR_EACH_TARGET(unsigned, bound_level,
                     (const LevelBound::Parameters& b, const Discs& discs, Lanes& z), (b, discs, z))

}  // namespace

std::optional<LevelBound> LevelBound::make(const ToolPiece& slice, const ToolPose& from,
                                           const ToolPose& to) {
  const Vec3 up{0, 0, 1};
  if (!(from.axis == up && to.axis == up && from.tip_mm.z == to.tip_mm.z)) return std::nullopt;
  const Extent e = extent(slice);
  const double dx = to.tip_mm.x - from.tip_mm.x, dy = to.tip_mm.y - from.tip_mm.y;
  const double travel = std::sqrt(dx * dx + dy * dy), share = travel > 0 ? 1 / travel : 0;
  const double r0 = radius_at(slice, e.z0_mm), r1 = radius_at(slice, e.z1_mm);
  Parameters b{};
  b.x = from.tip_mm.x;
  b.y = from.tip_mm.y;
  b.dir_x = dx * share;
  b.dir_y = dy * share;
  b.travel = travel;
  b.behind = kRecedingMm * e.radius_mm * share;
  if (!(travel > 0)) b.behind = std::numeric_limits<double>::infinity();
  b.lowest = from.tip_mm.z + e.z0_mm;
  b.radius = e.radius_mm;
  if (const auto* arc = std::get_if<ArcPiece>(&slice)) {
    b.is_arc = true;
    b.center_r = arc->center_r_mm;
    b.center_z = from.tip_mm.z + arc->center_z_mm;
    b.arc_radius = arc->radius_mm;
  } else {
    b.inner_radius = std::min(r0, r1);
    b.lower_radius = r0;
    b.by_slope = r1 > r0 ? (e.z1_mm - e.z0_mm) / (r1 - r0) : 0;
  }
  return LevelBound(b);
}

unsigned LevelBound::lower_bound(const Discs& discs, Lanes& z_mm) const {
  return bound_level(b_, discs, z_mm);
}

}  // namespace kerf
