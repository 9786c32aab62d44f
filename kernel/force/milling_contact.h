// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "kernel/force/tool_side.h"
#include "kernel/math/vec3_lanes.h"

namespace kerf {

/// Points where eight points of the stock touch the tool, in a frame of the tool: x along the
/// direction from which angles count, y a quarter of a turn of the spindle later, z along the axis.
struct MillingContact {
  Vec3Lanes at;        ///< relative to the tip
  Lanes inverse_rho;   ///< 1 / distance from the axis, limited
  Lanes cosine, sine;  ///< of the angle; both 0 on the axis
  ToolSide::Nearest side;

  /// Returns the component of the surface's normal along a vector.
  KERF_INLINE Lanes normal_along(const Vec3Lanes& v) const {
    return side.radial * (cosine * v.x + sine * v.y) + side.axial * v.z;
  }
};

/// The paths of eight points over a motion.
struct PathLanes {
  Vec3Lanes forward;  ///< unit vectors; 0 where a point does not move
  Lanes length_mm;
};

/// Finds the poses at which a motion cut elements.
struct ContactSearch {
  const ToolSide& side;
  double inverse_rho_max;  ///< limit of MillingContact::inverse_rho
  double found_mm;         ///< distance from the surface at which the search ends
  std::int64_t evaluations = 0;

  KERF_INLINE MillingContact contact_at(const Vec3Lanes& at);
  KERF_INLINE MillingContact entered_at_once(const Vec3Lanes& start, const PathLanes& path);
  KERF_INLINE MillingContact entered(const Vec3Lanes& start, const PathLanes& path, int most);
};

KERF_INLINE MillingContact ContactSearch::contact_at(const Vec3Lanes& at) {
  evaluations += kLanes;
  const Lanes rho = square_root(at.x * at.x + at.y * at.y);
  const Lanes inverse = lesser(1.0 / rho, Lanes(inverse_rho_max));
  // Within the limit of the inverse, the direction is shortened, which matters little at the axis.
  const Lanes unit = select(rho > 0.0, 1.0 / rho, Lanes());
  return {at, inverse, at.x * unit, at.y * unit, side.at(rho, at.z)};
}

KERF_INLINE Vec3Lanes select(LaneMask mask, const Vec3Lanes& yes, const Vec3Lanes& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
KERF_INLINE MillingContact select(LaneMask mask, const MillingContact& yes,
                                  const MillingContact& no) {
  return {
      select(mask, yes.at, no.at),
      select(mask, yes.inverse_rho, no.inverse_rho),
      select(mask, yes.cosine, no.cosine),
      select(mask, yes.sine, no.sine),
      {select(mask, yes.side.distance_mm, no.side.distance_mm),
       select(mask, yes.side.radial, no.side.radial), select(mask, yes.side.axial, no.side.axial)}};
}

/// Returns where the tool reached elements that are at `start` before a motion that is short
/// relative to its radius: one step along the path, over which the surface turns little.
KERF_INLINE MillingContact ContactSearch::entered_at_once(const Vec3Lanes& start,
                                                          const PathLanes& path) {
  MillingContact c = contact_at(start);
  const Lanes slope = c.normal_along(path.forward);
  // A point that is already inside, by rounding, is not moved.
  const Lanes ahead = lesser(c.side.distance_mm / slope, path.length_mm);
  const Lanes step = select((slope > 0.0) & (ahead > 0.0), ahead, Lanes());
  const Lanes out = step * (path.forward.x * c.cosine + path.forward.y * c.sine) * c.inverse_rho;
  const Lanes turn = step * (path.forward.x * c.sine - path.forward.y * c.cosine) * c.inverse_rho;
  c.at = c.at - path.forward * step;
  c.inverse_rho = c.inverse_rho * (1.0 + out * (1.0 + out));
  const Lanes cosine = c.cosine - turn * c.sine;
  c.sine = c.sine + turn * c.cosine;
  c.cosine = cosine;
  return c;
}

/// Returns where the tool reached elements that are at `start` before the motion, by Newton's
/// method along the path with at most `most` evaluations of the surface. The distance from a convex
/// piece is convex along it, so the steps do not pass its surface; where they enter another piece,
/// the secant leads back. If the tool only passes an element, as rounding may cause, the nearest
/// pose found counts.
KERF_INLINE MillingContact ContactSearch::entered(const Vec3Lanes& start, const PathLanes& path,
                                                  int most) {
  MillingContact best = contact_at(start), last = best;
  Lanes travelled(0), before(0);
  LaneMask active = best.side.distance_mm > found_mm;
  for (int i = 1; i < most && any(active); ++i) {
    const Lanes distance = last.side.distance_mm, outside = best.side.distance_mm;
    const Lanes slope = last.normal_along(path.forward);
    const Lanes ahead = travelled + select(slope > 0.0, distance / slope, distance);
    const Lanes back = before + (travelled - before) * (outside / (outside - distance));
    const Lanes next = lesser(select(distance < 0.0, back, ahead), path.length_mm);
    active = active & (next > before) & ~(next == travelled);
    travelled = select(active, next, travelled);
    last = select(active, contact_at(start - path.forward * travelled), last);
    const Lanes reached = last.side.distance_mm;
    const LaneMask nearer = active & (reached >= 0.0) & (reached <= outside);
    best = select(nearer, last, best);
    before = select(nearer, travelled, before);
    active = active & (best.side.distance_mm > found_mm);
  }
  return best;
}

}  // namespace kerf
