// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/surface_weight.h"

#include <limits>

#include "kernel/math/lanes.h"

namespace kerf {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Segments longer than this share of the tool's radius are weighted at two points. For a shorter
/// segment of a ball, the error of the weight at its center is below 1/100.
constexpr double kShortSegment = 0.25;

}  // namespace

/// The points of a group in the tool's half-plane. A unit vector (a, b) of the half-plane has the
/// component a · radial_z + b · axis_z along the rays.
struct SurfaceWeight::Meridian {
  Lanes rho2, h;   ///< squared distance from the axis, height
  Lanes across_z;  ///< component along the rays of the vector from the axis to the point
  double axis_z;

  KERF_INLINE Lanes rho() const { return square_root(rho2); }
  KERF_INLINE Lanes radial_z(const Lanes& rho_mm) const {
    return select(rho_mm > 0.0, across_z / rho_mm, Lanes{});
  }
};

SurfaceWeight::SurfaceWeight(const Tool& tool) : pieces_(covered_pieces(tool)) {}

/// Updates `nearest`, and the normal's component along the rays, where a piece is nearer than the
/// pieces before it (less far outside, or the point deeper inside).
KERF_INLINE void SurfaceWeight::nearest_of(const CoveredPiece& p, const Meridian& at,
                                           Lanes& nearest, Lanes& normal_z) {
  const PieceProfile& f = p.profile;
  const Lanes below = f.z0_mm - at.h, above = at.h - f.z1_mm;
  Lanes face, n;  // signed distance from the side, and its normal along the rays
  if (f.side != PieceProfile::Side::kLine && f.center_r_mm == 0) {
    // For a ball on the axis the normal needs no distance from the axis.
    const Lanes up = at.h - f.center_z_mm;
    const Lanes d = square_root(at.rho2 + up * up);
    face = d - f.radius_mm;
    n = select(d > 0.0, (at.across_z + up * at.axis_z) / d, Lanes{});
  } else {
    const Lanes rho = at.rho();
    if (f.side == PieceProfile::Side::kLine) {
      face = f.line_distance(rho, at.h);
      n = (at.radial_z(rho) - f.line.slope * at.axis_z) * f.line.cosine;
    } else {
      const CircleDistance<Lanes> d = f.arc_distance(rho, at.h);
      face = d.mm;
      n = select(d.length > 0.0, (d.across * at.radial_z(rho) + d.along * at.axis_z) / d.length,
                 Lanes{});
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
  for (const CoveredPiece& p : pieces_) {
    // Most points are near one piece only. The remaining pieces need no square root.
    const Lanes beside = greater(p.profile.z0_mm - at.h, at.h - p.profile.z1_mm);
    if (any(beside < nearest)) nearest_of(p, at, nearest, normal_z);
  }
  return normal_z * normal_z;
}

KERF_INLINE void SurfaceWeight::weigh_in_lanes(std::span<GroupSegments> groups, Vec3 axis,
                                               double radius_mm) const {
  // The two Gauss points, at 1/√12 of the length from the center.
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
