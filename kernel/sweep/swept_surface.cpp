// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/swept_surface.h"

#include <cmath>
#include <limits>

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

constexpr int kNearestSteps = 120;

/// Steps towards the share at which a ball's center is closest. A straight path needs one, and a
/// bent one deviates little from its chord.
constexpr int kBallSteps = 2;

KERF_INLINE Vec3Lanes select(const LaneMask& condition, const Vec3Lanes& yes, const Vec3Lanes& no) {
  return {kerf::select(condition, yes.x, no.x), kerf::select(condition, yes.y, no.y),
          kerf::select(condition, yes.z, no.z)};
}

/// Returns a mask with lane i true where bit i is set.
KERF_INLINE LaneMask lanes_of(unsigned bits) {
  Lanes v{};
  for (int i = 0; i < kLanes; ++i) v.set(i, bits >> i & 1U);
  return v > 0.0;
}

}  // namespace

SweptSurface::SweptSurface(const Tool& tool, const ToolMotion& motion)
    : frame_(motion.from, motion.to),
      speed_max_(length(frame_.v) + frame_.turn * (tool.length_mm + tool.radius_mm)) {
  for (const ToolPiece& piece : tool.pieces) pieces_.emplace_back(piece);
}

KERF_INLINE SweptSurface::Contact SweptSurface::contact(const PieceProfile& p,
                                                        const Vec3Lanes& point, Lanes share) const {
  const TurningFrame::Poses pose = frame_.at(share);
  const Vec3Lanes q = point - pose.tip;
  const Lanes h = dot(q, pose.u);
  const Vec3Lanes radial = q - pose.u * h;
  const Lanes rho = square_root(dot(radial, radial));
  const Vec3Lanes e = radial * kerf::select(rho > 0.0, 1 / rho, Lanes(0));
  Contact c;
  Lanes along;  // The side's normal is across · e + along · u.
  Lanes across;
  if (p.side == PieceProfile::Side::kLine) {
    c.gap = p.line_distance(rho, h);
    across = p.line.cosine;
    along = -p.line.slope * p.line.cosine;
  } else {
    const CircleDistance<Lanes> d = p.arc_distance(rho, h);
    const Lanes inverse = kerf::select(d.length > 0.0, 1 / d.length, Lanes(0));
    c.gap = d.mm;
    across = d.across * inverse;
    along = d.along * inverse;
  }
  const Lanes below = p.z0_mm - h, above = h - p.z1_mm;
  c.by_side = c.gap - greater(below, above);
  const LaneMask on_low = below > c.gap;
  c.gap = kerf::select(on_low, below, c.gap);
  const LaneMask on_high = above > c.gap;
  c.gap = kerf::select(on_high, above, c.gap);
  across = kerf::select(on_low | on_high, Lanes(0), across);
  along = kerf::select(on_high, Lanes(1), kerf::select(on_low, Lanes(-1), along));
  c.normal = e * across + pose.u * along;
  c.advance = dot(c.normal, frame_.velocity(q));
  return c;
}

/// Contact of a ball. Its center moves on a nearly straight line, so projections on the tangent
/// find the closest share.
KERF_INLINE SweptSurface::Contact SweptSurface::ball_contact(const PieceProfile& ball,
                                                             const Vec3Lanes& point) const {
  Vec3Lanes to_point{};
  if (frame_.turn == 0) {
    const Vec3 middle = frame_.u * ball.center_z_mm, v = frame_.v;
    const double speed2 = dot(v, v), inverse = speed2 > 0 ? 1 / speed2 : 0;
    to_point = {point.x - middle.x, point.y - middle.y, point.z - middle.z};
    const Lanes along = (to_point.x * v.x + to_point.y * v.y + to_point.z * v.z) * inverse;
    const Lanes m = lesser(greater(along, Lanes(-0.5)), Lanes(0.5));
    to_point = to_point - v * m;
  } else {
    Lanes share = 0.5;
    for (int i = 0; i <= kBallSteps; ++i) {
      const TurningFrame::Poses pose = frame_.at(share);
      const Vec3Lanes arm = pose.u * Lanes(ball.center_z_mm);
      to_point = point - pose.tip - arm;
      if (i == kBallSteps) break;
      const Vec3Lanes v = frame_.velocity(arm);
      const Lanes speed2 = dot(v, v);
      const Lanes step = kerf::select(speed2 > 0.0, dot(to_point, v) / speed2, Lanes(0));
      share = lesser(greater(share + step, Lanes(0)), Lanes(1));
    }
  }
  // The code of a normal does not depend on its length.
  return {square_root(dot(to_point, to_point)) - ball.radius_mm, to_point, Lanes(0), Lanes(0)};
}

/// Returns the contact of a piece at the share at which it is closest to the point. The share is
/// bracketed by the sign of n·V and found by regula falsi in the Illinois variant with bisections.
/// If n·V jumps, because the nearest surface changes between side and disc, the difference of their
/// distances is used instead.
KERF_INLINE SweptSurface::Contact SweptSurface::nearest(const PieceProfile& piece,
                                                        const Vec3Lanes& point,
                                                        LaneMask asked) const {
  if (piece.side == PieceProfile::Side::kBall) return ball_contact(piece, point);
  Contact first = contact(piece, point, Lanes(0)), last = contact(piece, point, Lanes(1));
  // A piece that recedes from the start on touches there; one that advances up to the end touches
  // there.
  const LaneMask at_start = first.advance <= 0.0, at_end = last.advance >= 0.0;
  LaneMask searching = asked & ~at_start & ~at_end;
  Contact found = last;
  found.gap = kerf::select(at_start, first.gap, last.gap);
  found.normal = select(at_start, first.normal, last.normal);
  Lanes a = Lanes(0), b = Lanes(1), weight_a = Lanes(1), weight_b = Lanes(1);
  Lanes wide = Lanes(1);
  LaneMask was_later = ~every_lane(), was_sooner = was_later;
  for (int i = 0; i < kNearestSteps && any(searching); ++i) {
    Lanes s = (a + b) * 0.5;
    const LaneMask jumps = first.by_side * last.by_side < 0.0;
    const Lanes fa = weight_a * kerf::select(jumps, first.by_side, first.advance);
    const Lanes fb = weight_b * kerf::select(jumps, last.by_side, last.advance);
    const Lanes falsi = a + (b - a) * (fa / (fa - fb));
    LaneMask usable = (falsi > a) & (falsi < b);
    if (i % 3 == 2) {
      usable &= b - a <= 0.5 * wide;
      wide = b - a;
    }
    s = kerf::select(usable, falsi, s);
    const Contact c = contact(piece, point, s);
    const LaneMask later = searching & (c.advance > 0.0), sooner = searching & (c.advance < 0.0);
    const LaneMask there = searching & (c.advance == 0.0);
    // An end of the bracket that stays twice counts half, so that the other end moves too
    // (Illinois).
    weight_a = kerf::select(later, Lanes(1), kerf::select(was_sooner, weight_a * 0.5, weight_a));
    weight_b = kerf::select(sooner, Lanes(1), kerf::select(was_later, weight_b * 0.5, weight_b));
    was_later = later;
    was_sooner = sooner;
    a = kerf::select(later, s, a);
    b = kerf::select(sooner, s, b);
    first.advance = kerf::select(later, c.advance, first.advance);
    last.advance = kerf::select(sooner, c.advance, last.advance);
    first.by_side = kerf::select(later, c.by_side, first.by_side);
    last.by_side = kerf::select(sooner, c.by_side, last.by_side);
    first.normal = select(later, c.normal, first.normal);
    last.normal = select(sooner, c.normal, last.normal);
    found.gap = kerf::select(searching, c.gap, found.gap);
    found.normal = select(there, c.normal, found.normal);
    searching &= ~there;
    const LaneMask close = searching & ((b - a) * speed_max_ <= kTouchSearchMm);
    // Interpolated between the normals on both sides of the minimum: those of the two surfaces of
    // an edge, or of one surface at two nearly equal points.
    const Lanes weight = first.advance / (first.advance - last.advance);
    const Vec3Lanes between = first.normal * (1 - weight) + last.normal * weight;
    found.normal = select(close, between, found.normal);
    searching &= ~close;
  }
  return found;
}

KERF_INLINE void SweptSurface::stock_normals_in_lanes(const Vec3Lanes& ends_mm, unsigned asked,
                                                      double towards, NormalCode* codes) const {
  const Vec3Lanes point{ends_mm.x - frame_.tip.x, ends_mm.y - frame_.tip.y,
                        ends_mm.z - frame_.tip.z};
  const LaneMask active = lanes_of(asked);
  Lanes least = std::numeric_limits<double>::infinity();
  Vec3Lanes outward{};
  for (const PieceProfile& piece : pieces_) {
    const LaneMask open = active & (least > kOnSurfaceMm);
    if (!any(open)) break;
    const Contact c = nearest(piece, point, open);
    const LaneMask nearer = open & (c.gap < least);
    least = kerf::select(nearer, c.gap, least);
    outward = select(nearer, c.normal, outward);
  }
  Vec3Lanes n{-outward.x, -outward.y, -outward.z};
  // On a surface that the ray grazes, rounding may turn the normal to the wrong side.
  n.z = kerf::select(n.z * towards < 0.0, Lanes(0), n.z);
  const LaneMask none = magnitude(n.x) + magnitude(n.y) + magnitude(n.z) <= 0.0;
  n.z = kerf::select(none, Lanes(towards), n.z);
  encode_normals(n, codes);
}

namespace {

KERF_INLINE void find_stock_normals_in_lanes(const SweptSurface& surface, const Vec3Lanes& ends_mm,
                                             unsigned asked, double towards, NormalCode* codes) {
  surface.stock_normals_in_lanes(ends_mm, asked, towards, codes);
}
KERF_FOR_EACH_TARGET(void, find_stock_normals,
                     (const SweptSurface& surface, const Vec3Lanes& ends_mm, unsigned asked,
                      double towards, NormalCode* codes),
                     (surface, ends_mm, asked, towards, codes))

}  // namespace

void SweptSurface::stock_normals(const Vec3Lanes& ends_mm, unsigned asked, double towards,
                                 NormalCode* codes) const {
  find_stock_normals(*this, ends_mm, asked, towards, codes);
}

}  // namespace kerf
