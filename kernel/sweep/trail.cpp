// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/trail.h"

#include <algorithm>
#include <cmath>

#include "kernel/sweep/turning_frame.h"

namespace kerf {
namespace {

/// Minimum horizontal component of the axis for a position in the plane to determine the height of
/// the slice there.
constexpr double kLevelMin = 0.2;

/// Returns an upper bound of n·V times the radius, at the height l and the offset (dx, dy) from the
/// tip.
KERF_INLINE Lanes outward(const Trail::Motion& m, Lanes dx, Lanes dy, Lanes l) {
  const Lanes turning = m.m0 + m.m1 * l;
  const Lanes vx = m.v.x + turning * m.w.x, vy = m.v.y + turning * m.w.y;
  const Lanes vz = m.v.z + turning * m.w.z;
  const Lanes along_plane = (dx - l * m.axis.x) * vx + (dy - l * m.axis.y) * vy;
  return along_plane + m.radius * m.lean * magnitude(vz) - (m.climb0 + m.climb1 * l);
}

KERF_INLINE unsigned behind_discs_in_lanes(const Trail::Motion& m, const Discs& discs) {
  const double reach = discs.reach_mm;
  const Lanes dx = discs.x_mm - m.tip.x, dy = discs.y_mm - m.tip.y;
  Lanes low = Lanes(m.low), high = Lanes(m.high);
  LaneMask clear = every_lane();
  if (!m.whole) {
    const Lanes along = (dx * m.axis.x + dy * m.axis.y) * (1 / m.level);
    const double spread = m.half_travel + reach + m.aside;
    const Lanes first = along - spread, last = along + spread;
    const Lanes l0 = lesser(first * (1 / m.level_min), first * (1 / m.level_max));
    const Lanes l1 = greater(last * (1 / m.level_min), last * (1 / m.level_max));
    if (m.shows_edge) clear = (l0 > m.low) & (l1 < m.high);
    low = lesser(greater(l0, low), high);
    high = greater(lesser(l1, high), Lanes(m.low));
  }
  const Lanes ends = greater(outward(m, dx, dy, low), outward(m, dx, dy, high));
  const Lanes between = m.bend * (high - low) * (high - low);
  const double allowance = reach * m.level_speed + m.margin + reach * m.margin_per_mm;
  return bits(clear & (ends + between + allowance < 0.0));
}
KERF_FOR_EACH_TARGET(unsigned, behind_discs, (const Trail::Motion& m, const Discs& discs),
                     (m, discs))

}  // namespace

Trail::Trail(const FrustumPiece& p, const ToolPose& from, const ToolPose& to, bool shows_edge) {
  const TurningFrame f(from, to);
  const double slope = kerf::slope(p);
  m_.tip = f.tip;
  m_.axis = f.u;
  m_.v = f.v;
  m_.w = f.w * f.turn;
  m_.low = p.z0_mm;
  m_.high = p.z1_mm;
  // The normal is e − k u, so m = l + k r with r = r0 + k (l − low), and the climb is k r u·v.
  const double r_at_0 = p.r0_mm - slope * p.z0_mm;
  m_.m0 = slope * r_at_0;
  m_.m1 = 1 + slope * slope;
  const double climb = slope * dot(f.u, f.v);
  m_.climb0 = climb * r_at_0;
  m_.climb1 = climb * slope;
  m_.radius = extent(p).radius_mm;
  m_.lean = std::sqrt(std::max(0.0, 1 - f.u.z * f.u.z));
  m_.level = std::sqrt(f.u.x * f.u.x + f.u.y * f.u.y);

  const double half_turn = f.turn / 2;
  m_.level_min = m_.level - half_turn;
  m_.level_max = m_.level + half_turn;
  m_.whole = !(m_.level_min > kLevelMin);
  m_.aside = m_.radius * std::sqrt(std::max(0.0, 1 - m_.level_min * m_.level_min));
  m_.half_travel = std::sqrt(f.v.x * f.v.x + f.v.y * f.v.y) / 2;
  m_.shows_edge = shows_edge;
  m_.bend = m_.m1 * std::max(0.0, f.u.x * m_.w.x + f.u.y * m_.w.y) / 4;

  // All quantities are those in the middle of the motion. The margins bound their change until its
  // ends, where the axis, and w with it, have turned by half the turn.
  m_.level_speed = 0;
  double speed = 0, turning = 0;
  for (const double l : {p.z0_mm, p.z1_mm}) {
    const double at = m_.m0 + m_.m1 * l;
    const Vec3 v = f.v + m_.w * at;
    speed = std::max(speed, length(v));
    m_.level_speed = std::max(m_.level_speed, std::sqrt(v.x * v.x + v.y * v.y));
    turning = std::max(turning, std::abs(at));
  }
  const double swerve = turning * f.turn * half_turn;
  const double r = m_.radius, fastest = speed + swerve;
  m_.margin = (m_.half_travel + (p.z1_mm + r) * half_turn) * fastest + 2 * r * swerve +
              std::abs(slope) * r * half_turn * length(f.v);
  m_.margin_per_mm = 2 * swerve;
}

unsigned Trail::behind(const Discs& discs) const {
  // An edge that may be over any position may also move outwards there.
  return m_.whole && m_.shows_edge ? 0 : behind_discs(m_, discs);
}

}  // namespace kerf
