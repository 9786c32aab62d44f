// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "kernel/math/tolerance.h"
#include "kernel/math/vec3_lanes.h"
#include "kernel/piece/arc.h"
#include "kernel/piece/frustum.h"

namespace kerf {

/// The end of a ray's interval that is searched.
enum class End { kLower, kUpper };

/// Heights at which eight rays enter and leave the slab between the discs of a piece, and 1 / u_z.
struct DiscSpan {
  Lanes in, out, inverse_uz;
  /// Upper ends at or above this height need not be exact, but must not be below it.
  Lanes top = Lanes(std::numeric_limits<double>::infinity());
};

/// Intervals of eight dexel rays inside the side of a piece, continued beyond its two discs.
/// Heights t relative to the piece's anchor.
struct SideSpan {
  Lanes in, out;    ///< may be infinite
  LaneMask exists;  ///< false if the ray misses the side
  Lanes closest;    ///< for misses: the height closest to the side
  Lanes depth;      ///< for hits: estimated depth of the ray in the side
};

/// A plane that supports the side below a nearby point may be tilted by an angle a towards the
/// rays. The point's distance from it falls by at most radius a²/2, and the plane's slope along the
/// rays grows by `gain` sin a.
struct SideTilt {
  Lanes radius, gain;
};

/// The planes of the discs of a slice, or of the level ends of an arc. A ray that crosses one well
/// within its radius enters or leaves the slice there. Heights are relative to the anchor of the
/// side.
struct DiscPlanes {
  /// Heights, and squared radii minus an allowance, or −1 without a disc.
  double low, low_radius2, high, high_radius2;

  static double square(double radius_mm) {
    const double within = radius_mm - kEdgeEpsilonMm;
    return radius_mm > kTipMm ? within * within : -1;
  }
  static DiscPlanes of(const FrustumPiece& p) {
    return {0, square(p.r0_mm), p.z1_mm - p.z0_mm, square(p.r1_mm)};
  }
  static DiscPlanes of(const ArcPiece& a) {
    const double r0 = is_level_below(a) ? a.center_r_mm : radius_at(a, a.z0_mm);
    const double r1 = is_level_above(a) ? a.center_r_mm : radius_at(a, a.z1_mm);
    return {std::max(a.z0_mm - a.center_z_mm, -a.radius_mm), square(r0),
            std::min(a.z1_mm - a.center_z_mm, a.radius_mm), square(r1)};
  }
};

/// The side of a frustum (paper Eq. 2; a cylinder if the slope is 0), anchored at the center of its
/// lower disc. With p = (x, y, t) from the anchor and l = p·u the side is |p|² − l² = (r0 + k l)²,
/// quadratic in t with A = u_x² + u_y² − k² u_z². If A > 0, the inside is between the roots. If A ≤
/// 0 (the ray is steeper than the generators), the inside is beyond one of them, on the nappe that
/// belongs to the tool. A tip has no disc: the nappe ends there.
struct ConeSide {
  double anchor, low, high;
  FrustumSide side;
  DiscPlanes planes;
  double widest;     ///< greatest radius of the piece
  double by_chord2;  ///< estimated depth of a ray in the side, per squared length of its chord

  explicit ConeSide(const FrustumPiece& p)
      : anchor(p.z0_mm),
        low(p.r0_mm > kTipMm ? 0 : p.z0_mm - p.z1_mm),
        high((p.r1_mm > kTipMm ? 1 : 2) * (p.z1_mm - p.z0_mm)),
        side(p),
        planes(DiscPlanes::of(p)),
        widest(extent(p).radius_mm),
        by_chord2(0.125 / extent(p).radius_mm) {}

  /// `along` = x u_x + y u_y.
  template <End end>
  KERF_INLINE SideSpan meet(Lanes x, Lanes y, const Vec3Lanes& u, Lanes along,
                            const DiscSpan&) const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const double r0 = side.r0_mm, slope = side.slope, k1 = 1 + slope * slope;
    const Lanes a = u.x * u.x + u.y * u.y - slope * slope * (u.z * u.z);
    const Lanes b = -(k1 * along + r0 * slope) * u.z;
    const Lanes c = x * x + y * y - k1 * along * along - 2 * r0 * slope * along - r0 * r0;
    const Lanes inside = b * b - a * c;
    const Lanes root = square_root(greater(inside, Lanes(0)));
    const Lanes q = select(b < 0.0, root - b, -b - root);
    const Lanes inverse_a = 1 / a;
    // A ray parallel to a generator has one root.
    const Lanes by_a = q * inverse_a, t1 = select(q == 0.0, by_a, c / q);
    const Lanes t0 = select(a == 0.0, t1, by_a);
    const Lanes first = select(t1 < t0, t1, t0), second = select(t1 < t0, t0, t1);
    const LaneMask convex = a > 0.0;
    const LaneMask upwards = u.z * slope > 0.0;
    // For an upright cylinder, the whole ray is inside, or none of it.
    const LaneMask parallel = (a == 0.0) & (b == 0.0);
    Lanes in = select(convex, first, select(upwards, second, Lanes(-kInfinity)));
    Lanes out = select(convex, second, select(upwards, Lanes(kInfinity), first));
    in = select(parallel, Lanes(-kInfinity), in);
    out = select(parallel, Lanes(kInfinity), out);
    // Between two roots the ray may be inside the mirrored nappe, which is not part of the tool.
    const LaneMask own_nappe = r0 + slope * (along - u.z * b * inverse_a) >= 0.0;
    const LaneMask exists =
        (convex & (inside >= 0.0) & own_nappe) | (~convex & ~parallel) | (parallel & (c <= 0.0));
    Lanes closest = Lanes(0);
    if (any(convex & ~exists)) closest = select(convex, closest_to(x, y, u, along, a), closest);
    const Lanes chord = out - in;
    return {in, out, exists, closest, chord * chord * by_chord2 * (u.x * u.x + u.y * u.y)};
  }
  /// Returns the outward normal, of any length, at the point p = (x, y, t) with l = p·u: the
  /// gradient of ρ − (r0 + k l), where ρ is the distance from the axis.
  KERF_INLINE Vec3Lanes normal(const Vec3Lanes& p, Lanes l, const Vec3Lanes& u) const {
    const Vec3Lanes radial = p - u * l;
    return radial - u * (side.slope * square_root(dot(radial, radial)));
  }
  /// Returns the distance of the point p from the side, negative inside.
  KERF_INLINE Lanes clearance(const Vec3Lanes& p, Lanes l, const Vec3Lanes& u) const {
    const Vec3Lanes radial = p - u * l;
    return side.distance(square_root(dot(radial, radial)), l);
  }
  /// Returns how a plane that supports the side may be tilted towards the rays: its normal turns
  /// about the axis.
  KERF_INLINE SideTilt tilt(const Vec3Lanes& p, Lanes l, const Vec3Lanes& u, const Vec3Lanes&,
                            Lanes) const {
    const Vec3Lanes radial = p - u * l;
    const Lanes rho = square_root(dot(radial, radial));
    const double cosine2 = 1 / (1 + side.slope * side.slope);
    return {rho, magnitude(u.x * radial.y - u.y * radial.x) * std::sqrt(cosine2) / rho};
  }
  /// Returns the lanes in which a point at the squared distance `rho2` from the axis, at l, is well
  /// inside.
  KERF_INLINE LaneMask holds(Lanes rho2, Lanes l) const {
    const Lanes r = side.r0_mm + side.slope * l - kEdgeEpsilonMm;
    return (r > 0.0) & (rho2 <= r * r);
  }

 private:
  /// Returns the height at which ρ − (r0 + k l), convex along a ray, is least, for rays with A > 0:
  /// t0 + k u_z ρ1 / α with α = u_x² + u_y², t0 the height nearest to the axis, ρ0 the distance
  /// there and ρ1 = ρ0 √(α / A).
  KERF_INLINE Lanes closest_to(Lanes x, Lanes y, const Vec3Lanes& u, Lanes along, Lanes a) const {
    const Lanes lean2 = u.x * u.x + u.y * u.y;
    const Lanes t0 = along * u.z / lean2;
    const Lanes l0 = along + u.z * t0;
    const Lanes rho2 = greater(x * x + y * y + t0 * t0 - l0 * l0, Lanes(0));
    return t0 + side.slope * u.z * square_root(rho2 / (lean2 * a));
  }
};

/// The side of an arc piece, anchored at the height of the arc's center: F = √(m² + l²) − radius =
/// 0, where m is the distance from the tool's axis minus center_r, at least zero. F is convex along
/// a ray, so Newton's method from outside approaches its roots monotonically. A disc that continues
/// the side without an edge, or is only a tip, is left out, because the side already bounds the
/// piece there.
struct ArcSide {
  double anchor, low, high, center_r, radius, reach, half_height;
  DiscPlanes planes;
  double widest;  ///< greatest radius of the piece

  explicit ArcSide(const ArcPiece& p)
      : anchor(p.center_z_mm),
        low(is_level_below(p) || radius_at(p, p.z0_mm) <= kTipMm ? -2 * p.radius_mm
                                                                 : p.z0_mm - p.center_z_mm),
        high(is_level_above(p) || radius_at(p, p.z1_mm) <= kTipMm ? 2 * p.radius_mm
                                                                  : p.z1_mm - p.center_z_mm),
        center_r(p.center_r_mm),
        radius(p.radius_mm),
        reach(p.center_r_mm >= 0 ? p.center_r_mm + p.radius_mm
                                 : std::sqrt(std::max(0.0, p.radius_mm * p.radius_mm -
                                                               p.center_r_mm * p.center_r_mm))),
        half_height(std::min(radius, reach)),
        planes(DiscPlanes::of(p)),
        widest(extent(p).radius_mm) {}

  /// Computes `end` of the intervals exactly, and the other end only up to the disc there.
  template <End end>
  KERF_INLINE SideSpan meet(Lanes x, Lanes y, const Vec3Lanes& u, Lanes along,
                            const DiscSpan& discs) const {
    const Lanes p2 = x * x + y * y;
    const Lanes ball2 = reach * reach - p2;
    const Lanes half = square_root(greater(ball2, Lanes(0)));
    const Lanes middle = -along * discs.inverse_uz;
    const Lanes thick = half_height * magnitude(discs.inverse_uz);
    Lanes in = greater(middle - thick, -half), out = lesser(middle + thick, half);
    const LaneMask near = (ball2 >= 0.0) & (in <= out);
    SideSpan span;
    if (end == End::kLower) {
      solve<1>(p2, u.z, along, near, out - in, in, span);
      span.in = in;
      span.out = select(discs.out > in, lesser(out, discs.out), out);
      LaneMask asked = span.exists & ~ends_on_disc(p2, u.z, along, span.out, discs.out);
      const LaneMask over_top = asked & (discs.top <= span.out) & (discs.top >= discs.in);
      if (any(over_top)) asked &= ~(over_top & holds_at(p2, u.z, along, discs.top));
      if (any(asked)) approach<-1>(p2, u.z, along, asked, span.out);
    } else {
      solve<-1>(p2, u.z, along, near, out - in, out, span);
      span.out = out;
      span.in = select(discs.in < out, greater(in, discs.in), in);
      const LaneMask asked = span.exists & ~ends_on_disc(p2, u.z, along, span.in, discs.in);
      if (any(asked)) approach<1>(p2, u.z, along, asked, span.in);
    }
    return span;
  }
  KERF_INLINE Vec3Lanes normal(const Vec3Lanes& p, Lanes l, const Vec3Lanes& u) const {
    const Vec3Lanes q = p - u * l;
    const Lanes rho = square_root(dot(q, q));
    const Lanes share = select(rho > center_r, 1 - center_r / rho, Lanes(0));
    return q * select(share == share, share, Lanes(1)) + u * l;
  }
  /// Returns the distance of the point p from the side, negative inside.
  KERF_INLINE Lanes clearance(const Vec3Lanes& p, Lanes l, const Vec3Lanes& u) const {
    const Vec3Lanes q = p - u * l;
    return circle_distance(center_r, radius, square_root(dot(q, q)), l).mm;
  }
  /// Returns how a plane that supports the side may be tilted towards the rays. `n` is the unit
  /// normal at p, `off` the distance from the side.
  KERF_INLINE SideTilt tilt(const Vec3Lanes&, Lanes, const Vec3Lanes& u, const Vec3Lanes& n,
                            Lanes off) const {
    const Lanes axial = dot(n, u);
    const Lanes across = square_root(greater(1 - axial * axial, Lanes(0)));
    return {radius + std::max(center_r, 0.0) / across + off,
            square_root(greater(1 - n.z * n.z, Lanes(0)))};
  }
  /// Returns the lanes in which a point at the squared distance `rho2` from the axis, at l, is well
  /// inside.
  KERF_INLINE LaneMask holds(Lanes rho2, Lanes l) const {
    const Lanes m = greater(square_root(greater(rho2, Lanes(0))) - center_r, Lanes(0));
    return m * m + l * l <= (radius - kEdgeEpsilonMm) * (radius - kEdgeEpsilonMm);
  }

 private:
  static constexpr int kFastSteps = 12;  ///< two or three are usual
  /// Share of the ray's path through the box around the arc after which the search begins.
  static constexpr double kStartShare = 0.15;
  /// The third derivative of half G is at most 3 |c_r|/ρ² times |g (λ² − g²)| ≤ 2 λ³/√27, with g
  /// the growth of ρ and λ the sine of the lean. This is a sixth of that.
  static constexpr double kThirdShare = 0.1925;
  static constexpr int kSteps = 60;  ///< at a grazed arc each step halves the distance

  /// Half of G = m² + l² − R² at the height t of a ray, with half its derivatives along the ray.
  /// The derivatives of ρ² = |p|² − l² give ρ′ = (t − l u_z)/ρ and ρ″ = (1 − u_z² − ρ′²)/ρ.
  struct Square {
    Lanes off2, slope, bend;
    Lanes inverse2;   ///< 1 / ρ²
    LaneMask beyond;  ///< m > 0
  };
  KERF_INLINE Square square_at(Lanes p2, Lanes uz, Lanes along, Lanes t) const {
    const Lanes l = along + uz * t;
    const Lanes rho2 = greater(p2 + t * t - l * l, Lanes(kAxisAlongRayMin));
    const Lanes inverse = 1 / square_root(rho2);
    const Lanes m = greater(rho2 * inverse - center_r, Lanes(0));
    const Lanes growth = (t - l * uz) * inverse, lean2 = 1 - uz * uz;
    const Lanes bend = lean2 - (lean2 - growth * growth) * inverse * center_r;
    return {m * m + l * l - radius * radius, m * growth + l * uz,
            select(m > 0.0, bend, Lanes(0)) + uz * uz, inverse * inverse, m > 0.0};
  }
  /// Returns the rays that are well inside the side at t.
  KERF_INLINE LaneMask holds_at(Lanes p2, Lanes uz, Lanes along, Lanes t) const {
    const Lanes l = along + uz * t;
    return holds(p2 + t * t - l * l, l);
  }
  /// Returns the rays that cross a disc at t, inside the side.
  KERF_INLINE LaneMask ends_on_disc(Lanes p2, Lanes uz, Lanes along, Lanes t, Lanes disc) const {
    return (t == disc) & holds_at(p2, uz, along, t);
  }
  /// Returns the lanes in which m > 0 holds or not as where `g` was evaluated. Where it changes, G
  /// has a bend.
  KERF_INLINE LaneMask on_same_part(Lanes p2, Lanes uz, Lanes along, Lanes t,
                                    const Square& g) const {
    if (center_r <= 0) return every_lane();
    const Lanes l = along + uz * t;
    return ~((p2 + t * t - l * l > center_r * center_r) ^ g.beyond);
  }

  /// Moves t to the end of the interval of each ray, the lower (kSign 1) or the upper one (−1), and
  /// sets in `span` whether it exists, the closest height and the depth. `near` has the rays that
  /// enter the box around the arc, at t, and leave it `across` farther. Each step goes to the root,
  /// or to the vertex, of the parabola that touches G at t. For an upright axis G is that parabola.
  /// Otherwise G leaves it by at most step³/6 times its third derivative, which is at most 1.16
  /// |c_r| (1 − u_z²) / ρ² (kernel/sweep/README.md, "The tight model"), so a short step needs no
  /// check. Rays that do not converge are left to Newton's method from outside.
  template <int kSign>
  KERF_INLINE void solve(Lanes p2, Lanes uz, Lanes along, LaneMask near, Lanes across, Lanes& t,
                         SideSpan& span) const {
    const double found = 2 * radius * kArcFoundMm;
    const Lanes lean2 = 1 - uz * uz, third = lean2 * (kThirdShare * std::abs(center_r));
    t = select(near, t, Lanes(0));
    const Lanes start = t;
    t = t + select(near, across * (kSign * kStartShare), Lanes(0));
    LaneMask moving = every_lane(), misses = ~near;
    Lanes inside = Lanes(0), bend = Lanes(1);
    for (int i = 0; i < kFastSteps; ++i) {
      const Square g = square_at(p2, uz, along, t);
      const Lanes slope = g.slope * double(kSign);
      inside = select(moving, slope * slope - g.bend * g.off2, inside);
      bend = select(moving, g.bend, bend);
      const LaneMask beside = ~near | (inside < 0.0);
      const LaneMask arrived = ~beside & (magnitude(g.off2) <= found) & (slope <= 0.0);
      const Lanes root = square_root(greater(inside, Lanes(0)));
      const Lanes step = select(beside, -slope, g.off2) / select(beside, g.bend, root - slope);
      moving &= ~arrived;
      t = select(moving, t + step * double(kSign), t);
      misses = (misses & ~moving) | (beside & moving);
      const Lanes length = magnitude(step);
      const LaneMask settled = (length * length * length * third * g.inverse2 <= found) &
                               (length * length * g.inverse2 <= kArcShortStep2) &
                               on_same_part(p2, uz, along, t, g);
      moving &= ~((beside & (length <= kArcClosestMm)) | (~beside & settled));
      if (!any(moving)) break;
    }
    span.depth = inside / (2 * radius * bend);
    span.closest = t;
    span.exists = ~misses;
    if (!any(moving)) return;
    Lanes safe = start;
    const LaneMask reached = approach<kSign>(p2, uz, along, moving & near, safe);
    t = select(reached, safe, t);
    span.exists = (span.exists & ~moving) | reached;
    span.closest = select(moving & ~reached, closest_to(p2, uz, along), span.closest);
  }

  /// Returns the height at which a ray that misses is closest to the arc: where the slope of G
  /// along the ray changes sign. With θ the angle between the normal there and the axis, this is
  /// center_r |cos θ| away from the height nearest to the ball's center (less at a tip of the arc),
  /// for any gap.
  KERF_INLINE Lanes closest_to(Lanes p2, Lanes uz, Lanes along) const {
    const double farthest = std::abs(center_r);
    Lanes a = -farthest, b = farthest;
    for (double width = 2 * farthest; width > kArcClosestMm; width *= 0.5) {
      const Lanes t = (a + b) * 0.5;
      const LaneMask falling = square_at(p2, uz, along, t).slope < 0.0;
      a = select(falling, t, a);
      b = select(falling, b, t);
    }
    return (a + b) * 0.5;
  }

  /// Moves t from outside to the arc, upwards (kSign 1) or downwards (−1), in the lanes `asked`: to
  /// the root of the parabola that touches G, if G still falls there, then by Newton's steps, which
  /// stay outside. Returns the lanes that hit the arc.
  template <int kSign>
  KERF_INLINE LaneMask approach(Lanes p2, Lanes uz, Lanes along, LaneMask asked, Lanes& t) const {
    const double found = 2 * radius * kArcFoundMm;
    const auto closes = [](Lanes slope) __attribute__((always_inline)) {
      return kSign > 0 ? slope < 0.0 : slope > 0.0;
    };
    Square g = square_at(p2, uz, along, t);
    LaneMask met = asked, moving = asked & (g.off2 > found);
    if (!any(moving)) return met;
    const Lanes slope = g.slope * double(kSign);
    const Lanes step = g.off2 / (square_root(slope * slope - g.bend * g.off2) - slope);
    const LaneMask reaches = moving & (step > 0.0);
    const Lanes guess = select(reaches, t + step * double(kSign), t);
    const Square there = square_at(p2, uz, along, guess);
    const LaneMask usable = reaches & there.beyond & closes(there.slope);
    t = select(usable, guess, t);
    g.off2 = select(usable, there.off2, g.off2);
    g.slope = select(usable, there.slope, g.slope);
    moving &= magnitude(g.off2) > found;
    for (int i = 0; i < kSteps && any(moving); ++i) {
      met &= ~(moving & ~closes(g.slope));
      moving &= closes(g.slope);
      t = select(moving, t - 0.5 * g.off2 / g.slope, t);
      g = square_at(p2, uz, along, t);
      moving &= g.off2 > found;
    }
    return met;
  }
};

/// The side of a slice of either kind.
using PieceSide = std::variant<ConeSide, ArcSide>;

}  // namespace kerf
