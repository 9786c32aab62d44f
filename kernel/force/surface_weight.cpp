// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/surface_weight.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/math/lanes.h"

namespace kerf {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Radii that differ by less are the same: a piece that ends where the next begins.
constexpr double kCoverEpsilonMm = 1e-9;

/// Segments longer than this part of the tool's radius are weighted at two points: over one shorter
/// a ball's normal makes the weight of the middle wrong by less than a hundredth.
constexpr double kShortSegment = 0.25;

}  // namespace

/// The points of a group in the tool's half-plane. A unit vector (a, b) of the half-plane has the
/// component a · radial_z + b · axis_z along the rays.
struct SurfaceWeight::Meridian {
  Lanes rho2, h;   ///< squared distance from the axis, height
  Lanes across_z;  ///< component along the rays of the way from the axis, as long as it is
  double axis_z;

  KERF_INLINE Lanes rho() const { return square_root(rho2); }
  KERF_INLINE Lanes radial_z(const Lanes& rho_mm) const {
    return select(rho_mm > 0.0, across_z / rho_mm, Lanes{});
  }
};

double SurfaceWeight::Piece::radius_at(double h) const {
  if (h < z0 - kCoverEpsilonMm || h > z1 + kCoverEpsilonMm) return 0;
  if (side == Side::kLine) return r0 + slope * (h - z0);
  const double v = h - center_z;
  return center_r + std::sqrt(std::max(0.0, radius * radius - v * v));
}

SurfaceWeight::Piece SurfaceWeight::piece_of(const ToolPiece& piece) {
  Piece p{};
  if (const auto* f = std::get_if<FrustumPiece>(&piece)) {
    p.side = Side::kLine;
    p.z0 = f->z0_mm;
    p.z1 = f->z1_mm;
    p.r0 = f->r0_mm;
    p.slope = (f->r1_mm - f->r0_mm) / (f->z1_mm - f->z0_mm);
    p.normal_r = 1 / std::sqrt(1 + p.slope * p.slope);
    return p;
  }
  p.side = Side::kArc;
  if (const auto* ball = std::get_if<BallPiece>(&piece)) {
    p.center_z = ball->center_mm;
    p.radius = ball->radius_mm;
    p.z0 = p.center_z - p.radius;
    p.z1 = p.center_z + p.radius;
    return p;
  }
  const auto& arc = std::get<ArcPiece>(piece);
  p.center_r = arc.center_r_mm;
  p.center_z = arc.center_z_mm;
  p.radius = arc.radius_mm;
  p.z0 = arc.z0_mm;
  p.z1 = arc.z1_mm;
  return p;
}

SurfaceWeight::SurfaceWeight(const Tool& tool) {
  for (const ToolPiece& piece : tool.pieces) pieces_.push_back(piece_of(piece));
  for (Piece& p : pieces_) {
    double below = 0, above = 0;
    for (const Piece& other : pieces_) {
      if (&other == &p) continue;
      below = std::max(below, other.radius_at(p.z0));
      above = std::max(above, other.radius_at(p.z1));
    }
    const bool hides_below = below > p.radius_at(p.z0) - kCoverEpsilonMm;
    const bool hides_above = above > p.radius_at(p.z1) - kCoverEpsilonMm;
    p.covered_below2 = hides_below ? kInfinity : below * below;
    p.covered_above2 = hides_above ? kInfinity : above * above;
  }
}

/// Where a piece is nearer than what was found before (less far outside, or deeper around the
/// point), takes its distance and its normal's component along the rays.
KERF_INLINE void SurfaceWeight::nearest_of(const Piece& p, const Meridian& at, Lanes& nearest,
                                           Lanes& normal_z) {
  const Lanes below = p.z0 - at.h, above = at.h - p.z1;
  Lanes face, n;  // signed distance from the side, and its normal along the rays
  if (p.side == Side::kArc && p.center_r == 0) {
    const Lanes up = at.h - p.center_z;
    const Lanes d = square_root(at.rho2 + up * up);
    face = d - p.radius;
    n = select(d > 0.0, (at.across_z + up * at.axis_z) / d, Lanes{});
  } else {
    const Lanes rho = at.rho();
    if (p.side == Side::kLine) {
      face = (rho - p.r0 + p.slope * below) * p.normal_r;
      n = (at.radial_z(rho) - p.slope * at.axis_z) * p.normal_r;
    } else {
      const Lanes out = greater(rho - p.center_r, Lanes{});
      const Lanes up = at.h - p.center_z;
      const Lanes d = square_root(out * out + up * up);
      face = d - p.radius;
      n = select(d > 0.0, (out * at.radial_z(rho) + up * at.axis_z) / d, Lanes{});
    }
  }
  const Lanes distance = greater(greater(face, below), above);
  const LaneMask lower = (at.rho2 > p.covered_below2) & (below > face);
  face = select(lower, below, face);
  const LaneMask upper = (at.rho2 > p.covered_above2) & (above > face);
  n = select(lower, Lanes(-at.axis_z), n);
  n = select(upper, Lanes(at.axis_z), n);
  const LaneMask nearer = distance < nearest;
  nearest = select(nearer, distance, nearest);
  normal_z = select(nearer, n, normal_z);
}

KERF_INLINE Lanes SurfaceWeight::evaluate_in_lanes(const GroupPoints& points, Vec3 axis) const {
  const Lanes x = points.x, z = points.z;
  const double y = points.y;
  Meridian at;
  at.axis_z = axis.z;
  at.h = x * axis.x + y * axis.y + z * axis.z;
  const Lanes qx = x - at.h * axis.x, qy = y - at.h * axis.y, qz = z - at.h * axis.z;
  at.rho2 = qx * qx + qy * qy + qz * qz;
  at.across_z = qz;
  Lanes nearest(kInfinity), normal_z(0);
  for (const Piece& p : pieces_) {
    // Most points lie beside all pieces but one: those need no root.
    if (any(greater(p.z0 - at.h, at.h - p.z1) < nearest)) nearest_of(p, at, nearest, normal_z);
  }
  return normal_z * normal_z;
}

KERF_INLINE void SurfaceWeight::weigh_in_lanes(std::span<GroupSegments> groups, Vec3 axis,
                                               double radius_mm) const {
  // Gauss's two points, a half and 1/√12 of the length apart from the middle.
  constexpr double kGauss = 0.28867513459481287;
  const Lanes short_mm = kShortSegment * radius_mm;
  for (GroupSegments& g : groups) {
    if (!any(g.length > short_mm)) {
      g.length = g.length * evaluate_in_lanes(g.middle, axis);
      continue;
    }
    GroupPoints low = g.middle, high = g.middle;
    low.z = low.z - kGauss * g.length;
    high.z = high.z + kGauss * g.length;
    g.length = g.length * ((evaluate_in_lanes(low, axis) + evaluate_in_lanes(high, axis)) * 0.5);
  }
}

namespace {

KERF_INLINE void weights_in_lanes(const SurfaceWeight& surface, const GroupPoints& points,
                                  Vec3 axis, Lanes& weight) {
  weight = surface.evaluate_in_lanes(points, axis);
}
KERF_FOR_EACH_TARGET(void, weights,
                     (const SurfaceWeight& surface, const GroupPoints& points, Vec3 axis,
                      Lanes& weight),
                     (surface, points, axis, weight))

KERF_INLINE void weigh_all_in_lanes(const SurfaceWeight& surface, std::span<GroupSegments> groups,
                                    Vec3 axis, double radius_mm) {
  surface.weigh_in_lanes(groups, axis, radius_mm);
}
KERF_FOR_EACH_TARGET(void, weigh_all,
                     (const SurfaceWeight& surface, std::span<GroupSegments> groups, Vec3 axis,
                      double radius_mm),
                     (surface, groups, axis, radius_mm))

}  // namespace

void SurfaceWeight::evaluate(const GroupPoints& points, Vec3 axis, Lanes& weight) const {
  weights(*this, points, axis, weight);
}

void SurfaceWeight::weigh(std::span<GroupSegments> groups, Vec3 axis, double radius_mm) const {
  weigh_all(*this, groups, axis, radius_mm);
}

}  // namespace kerf
