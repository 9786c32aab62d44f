// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/trail.h"

#include <algorithm>
#include <cmath>

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Minimum horizontal component of the axis for a position in the plane to determine the height of
/// the slice there.
constexpr double kLevelMin = 0.2;
/// Minimum vertical component of the axis for a position in the plane to determine the axial speed
/// there.
constexpr double kAxialUprightMin = 0.3;
/// Allowance for rounding in the sines of an arc's part.
constexpr double kLeanMargin = 0x1p-26;
/// Least sine of the angle between rays and discs at the first and the last pose for which a disc
/// is known to be thin in the plane. A ray within a disc would meet it all along.
constexpr double kDiscLeanMin = 0x1p-20;

/// Returns an upper bound of n·V times the radius, at the height l and the offset (dx, dy) from the
/// tip.
KERF_INLINE Lanes outward(const Trail::Motion& m, Lanes dx, Lanes dy, Lanes l) {
  const Lanes turning = m.m0 + m.m1 * l;
  const Lanes vx = m.v.x + turning * m.w.x, vy = m.v.y + turning * m.w.y;
  const Lanes vz = m.v.z + turning * m.w.z;
  const Lanes along_plane = (dx - l * m.axis.x) * vx + (dy - l * m.axis.y) * vy;
  return along_plane + m.radius * m.lean * magnitude(vz) - (m.climb0 + m.climb1 * l);
}

/// A range of u·V, the speed of points of the slice along its axis.
struct AxialSpeed {
  Lanes least, most;
};

KERF_INLINE AxialSpeed axial_speed(const Trail::Motion& m, Lanes dx, Lanes dy, double reach,
                                   Lanes l) {
  const Lanes middle = m.axial - dx * m.axial_x - dy * m.axial_y - l * m.axial_l;
  const double spread = m.axial_margin + reach * m.axial_per_mm;
  return {middle - spread, middle + spread};
}

/// The positions over which none of the tested, or exposed, discs moves outwards.
struct DiscsRecede {
  LaneMask all = every_lane(), shown = every_lane();
};

KERF_INLINE DiscsRecede discs_recede(const Trail::Motion& m, Lanes dx, Lanes dy, double reach,
                                     const UntestedDiscs& untested) {
  DiscsRecede recede;
  for (int i = 0; i < m.face_count; ++i) {
    const Trail::Face& face = m.faces[i];
    const Lanes ax = dx - face.height * m.axis.x, ay = dy - face.height * m.axis.y;
    const double moved = reach + m.half_travel + face.height * m.half_turn;
    const double over = face.radius + moved, beside = face.radius * m.thickness + moved;
    const Lanes along = magnitude(ax * m.axis.x + ay * m.axis.y) * m.by_level;
    const AxialSpeed speed = axial_speed(m, dx, dy, reach, Lanes(face.height));
    const LaneMask recedes = (ax * ax + ay * ay > over * over) | (along > beside) |
                             (face.sign > 0 ? speed.most <= 0.0 : speed.least >= 0.0) |
                             mask_of(face.sign > 0 ? untested.upper : untested.lower);
    recede.all &= recedes;
    if (face.shown) recede.shown &= recedes;
  }
  return recede;
}

/// Distances from the axis of points of the slice over a disc of the plane, between two heights.
struct AxisDistances {
  Lanes least, most;
};

KERF_INLINE AxisDistances axis_distances(const Trail::Motion& m, Lanes dx, Lanes dy, double reach,
                                         Lanes low, Lanes high) {
  const auto at = [&](Lanes l) __attribute__((always_inline)) {
    const Lanes x = dx - l * m.axis.x, y = dy - l * m.axis.y;
    const Lanes z = (x * m.axis.x + y * m.axis.y) * m.by_upright;
    return Vec3Lanes{x, y, z};
  };
  const Vec3Lanes first = at(low), last = at(high), step = last - first;
  const Lanes at_low = square_root(dot(first, first)), at_high = square_root(dot(last, last));
  const double spread =
      (reach + m.half_travel + (m.high + m.radius) * m.half_turn) * std::abs(m.by_upright);
  // Between the two points, which are this far apart, the distance falls at most at unit rate.
  const Lanes least = (at_low + at_high - square_root(dot(step, step))) * 0.5 - spread;
  return {greater(least, Lanes(0)), greater(at_low, at_high) + spread};
}

/// Returns the lanes in which the side of an arc recedes at both ends of the part of it that may be
/// over the position, and so in between. `across` is an upper bound of q·V.
KERF_INLINE LaneMask arc_recedes(const Trail::Motion& m, Lanes dx, Lanes dy, double reach,
                                 Lanes across, Lanes low, Lanes high) {
  const AxialSpeed at_low = axial_speed(m, dx, dy, reach, low);
  const AxialSpeed at_high = axial_speed(m, dx, dy, reach, high);
  const Lanes least = lesser(at_low.least, at_high.least);
  const Lanes most = greater(at_low.most, at_high.most);
  Lanes lowest = Lanes(m.sine_low), highest = Lanes(m.sine_high);
  AxisDistances rho{Lanes(0), Lanes(m.radius)};
  if (m.by_upright != 0) {
    rho = axis_distances(m, dx, dy, reach, low, high);
    rho.most = lesser(rho.most, Lanes(m.radius));
    const Lanes inner = greater((rho.least - m.arc_center_r) * (1 / m.arc_radius), Lanes(0));
    const Lanes outer = greater((rho.most - m.arc_center_r) * (1 / m.arc_radius), Lanes(0));
    const Lanes steepest = square_root(greater(1 - inner * inner, Lanes(0))) + kLeanMargin;
    const Lanes flattest = square_root(greater(1 - outer * outer, Lanes(0))) - kLeanMargin;
    lowest = lesser(greater(-steepest, lowest), highest);
    highest = greater(lesser(m.sine_high > 0 ? steepest : -flattest, highest), lowest);
  }
  // Across the equator the bound consists of two sinusoids, which meet there.
  LaneMask recedes = (across < 0.0) | (lowest >= 0.0) | (highest <= 0.0);
  for (const Lanes& sine : {lowest, highest}) {
    const Lanes cosine = square_root(greater(1 - sine * sine, Lanes(0)));
    const Lanes along = select(sine > 0.0, most, least) * sine;
    recedes &= across * cosine + along * select(along > 0.0, rho.most, rho.least) <= 0.0;
  }
  return recedes;
}

KERF_INLINE Trail::Receding receding_discs_in_lanes(const Trail::Motion& m, const Discs& discs,
                                                    const UntestedDiscs& untested) {
  const double reach = discs.reach_mm;
  const Lanes dx = discs.x_mm - m.tip.x, dy = discs.y_mm - m.tip.y;
  Lanes low = Lanes(m.low), high = Lanes(m.high);
  if (!m.whole) {
    const Lanes along = (dx * m.axis.x + dy * m.axis.y) * (1 / m.level);
    const double spread = m.half_travel + reach + m.aside;
    const Lanes first = along - spread, last = along + spread;
    const Lanes l0 = lesser(first * (1 / m.level_min), first * (1 / m.level_max));
    const Lanes l1 = greater(last * (1 / m.level_min), last * (1 / m.level_max));
    low = lesser(greater(l0, low), high);
    high = greater(lesser(l1, high), Lanes(m.low));
  }
  const Lanes ends = greater(outward(m, dx, dy, low), outward(m, dx, dy, high));
  const Lanes between = m.bend * (high - low) * (high - low);
  const double allowance = reach * m.level_speed + m.margin + reach * m.margin_per_mm;
  const Lanes across = ends + between + allowance;
  const LaneMask recedes =
      m.is_arc ? arc_recedes(m, dx, dy, reach, across, low, high) : across < 0.0;
  if (!any(recedes)) return {};
  const DiscsRecede of_discs = discs_recede(m, dx, dy, reach, untested);
  return {bits(recedes & of_discs.all), bits(recedes & of_discs.shown)};
}

/// Returns whether a unit vector is along one of the coordinates.
bool is_coordinate(const Vec3& u) { return (u.x != 0) + (u.y != 0) + (u.z != 0) == 1; }

KERF_FOR_EACH_TARGET(Trail::Receding, receding_discs,
                     (const Trail::Motion& m, const Discs& discs, const UntestedDiscs& untested),
                     (m, discs, untested))

}  // namespace

Trail::Trail(const ToolPiece& slice, const ToolPose& from, const ToolPose& to, ShownDiscs tested,
             ShownDiscs shown) {
  const TurningFrame f(from, to);
  // For an arc, the bound of q·V is that of the enclosing cylinder.
  set_side(f, enclosing_frustum(slice));
  set_axial_speed(f);
  const auto* arc = std::get_if<ArcPiece>(&slice);
  m_.is_arc = arc != nullptr;
  m_.by_upright = 0;
  if (arc != nullptr) {
    const auto sine = [&](double z) {
      return std::clamp((z - arc->center_z_mm) / arc->radius_mm, -1.0, 1.0);
    };
    m_.sine_low = sine(arc->z0_mm);
    m_.sine_high = sine(arc->z1_mm);
    m_.arc_center_r = arc->center_r_mm;
    m_.arc_radius = arc->radius_mm;
    if (std::abs(f.u.z) >= kAxialUprightMin) m_.by_upright = 1 / f.u.z;
  }
  m_.face_count = 0;
  const auto add = [&](double sign, double height, bool shows) {
    m_.faces[m_.face_count++] = {sign, height, radius_at(slice, height), shows};
  };
  if (tested.lower) add(-1, m_.low, shown.lower);
  if (tested.upper) add(1, m_.high, shown.upper);
}

void Trail::set_side(const TurningFrame& f, const FrustumPiece& p) {
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
  m_.thickness = std::sqrt(std::max(0.0, 1 - m_.level_min * m_.level_min));
  m_.aside = m_.radius * m_.thickness;
  const double least_z = std::min(std::abs(f.from.axis.z), std::abs(f.to.axis.z));
  m_.by_level = m_.whole || least_z <= kDiscLeanMin ? 0 : 1 / m_.level;
  m_.half_travel = std::sqrt(f.v.x * f.v.x + f.v.y * f.v.y) / 2;
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
              std::abs(slope) * r * half_turn * length(f.v) + kRecedingMm * r * std::sqrt(m_.m1);
  m_.margin_per_mm = 2 * swerve;
}

/// A point at q from the axis has the speed u·V = u·v − w·q, w = Ω × u. Over the position p of the
/// plane, q = p − tip − l u within the plane across the axis. With the constant g = k × ẑ, k the
/// axis of the turn, u_z (w·q) = turn (g·(p − tip) + l w_z).
void Trail::set_axial_speed(const TurningFrame& f) {
  const double speed = length(f.v), upright = std::abs(f.u.z), half_turn = f.turn / 2;
  const double gx = f.k.y, gy = -f.k.x;
  m_.half_turn = half_turn;
  m_.axial = dot(f.u, f.v);
  m_.axial_x = m_.axial_y = m_.axial_l = m_.axial_per_mm = 0;
  if (f.turn == 0) {
    // In a level motion of an axis along one of the coordinates, the discs meet each ray at the
    // same height, to the bit, at every pose.
    m_.axial_margin = m_.axial == 0 && is_coordinate(f.u) ? 0 : kRecedingMm;
  } else if (upright < kAxialUprightMin) {
    m_.axial_margin = half_turn * speed + f.turn * m_.radius + kRecedingMm;
  } else {
    const double per_mm = f.turn * std::sqrt(gx * gx + gy * gy) / upright;
    m_.axial_x = f.turn * gx / f.u.z;
    m_.axial_y = f.turn * gy / f.u.z;
    m_.axial_l = f.turn * f.w.z / f.u.z;
    m_.axial_per_mm = per_mm;
    m_.axial_margin = half_turn * speed + per_mm * m_.half_travel +
                      f.turn * half_turn * (m_.high + m_.radius) / upright + kRecedingMm;
  }
}

Trail::Receding Trail::receding(const Discs& discs, UntestedDiscs untested) const {
  return receding_discs(m_, discs, untested);
}

}  // namespace kerf
