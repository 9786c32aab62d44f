// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/placed_part.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "kernel/math/rotation.h"
#include "kernel/math/tolerance.h"
#include "kernel/piece/bounds.h"

namespace kerf {
namespace {

/// Signed distance of a point (r, h) of the half-plane from a surface, negative inside.
struct Outside {
  double mm;
  double nr, nh;  ///< unit gradient
};

Outside outside(const FrustumPiece& f, double r, double h) {
  const FrustumSide side(f);
  return {side.distance(r, h - f.z0_mm), side.cosine, -side.slope * side.cosine};
}

/// Returns the distance from an arc, given whether other pieces adjoin it below and above. If one
/// does, the arc is continued along its tangent, otherwise as a circle.
Outside outside(const ArcPiece& a, double r, double h, bool joined_below, bool joined_above) {
  const double across = r - a.center_r_mm, along = h - a.center_z_mm;
  const auto tangent = [&](bool joined, double end) {
    const double nh = joined ? end / a.radius_mm : (end < 0 ? -1.0 : 1.0);
    const double nr = joined ? half_chord(a.radius_mm, end) / a.radius_mm : 0;
    return Outside{nr * across + nh * along - a.radius_mm, nr, nh};
  };
  const Outside below = joined_below ? tangent(true, a.z0_mm - a.center_z_mm) : tangent(false, -1);
  const Outside above = joined_above ? tangent(true, a.z1_mm - a.center_z_mm) : tangent(false, 1);
  const bool within =
      below.nr * along - below.nh * across >= 0 && above.nr * along - above.nh * across <= 0;
  if (!within) return below.mm > above.mm ? below : above;
  const double n = std::sqrt(across * across + along * along);
  return n > 0 ? Outside{n - a.radius_mm, across / n, along / n} : Outside{-a.radius_mm, 1, 0};
}

/// Signed distance function of a point from a part's side and bottom (PlacedPart::at).
Outside outside(const ConvexPart& part, double r, double h) {
  Outside most{-1e300, 1, 0};
  const std::size_t last = part.pieces.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) {
    const auto* arc = std::get_if<ArcPiece>(&part.pieces[k]);
    const Outside o = arc != nullptr ? outside(*arc, r, h, k > 0 || part.covered, k < last)
                                     : outside(std::get<FrustumPiece>(part.pieces[k]), r, h);
    if (o.mm > most.mm) most = o;
  }
  const double bottom = extent(part.pieces.front()).z0_mm - h;
  return bottom > most.mm && !part.covered ? Outside{bottom, 0, -1} : most;
}

constexpr int kSearchSteps = 60;  ///< each keeps at most 9/10 of the interval of heights

}  // namespace

PlacedPart::PlacedPart(const ConvexPart& part, const ToolPose& pose)
    : part_(part), pose_(pose), reach_(extent(part)) {
  const Bounds box = cylinder_bounds(reach_, pose.tip_mm, pose.axis);
  lo = box.lo_mm;
  hi = box.hi_mm;
}

double PlacedPart::at(Vec3 point, Vec3* outward) const {
  const Vec3 p = point - pose_.tip_mm;
  const double h = dot(p, pose_.axis);
  const Vec3 across = p - pose_.axis * h;
  const double r = length(across);
  const Outside o = outside(part_, r, h);
  if (outward != nullptr) {
    const Vec3 e = r > 0 ? across * (1 / r) : Vec3{};
    *outward = e * o.nr + pose_.axis * o.nh;
  }
  return o.mm;
}

Vec3 PlacedPart::exit_direction(Vec3 point) const {
  Vec3 outward;
  at(point, &outward);
  return outward == Vec3{} ? any_perpendicular(pose_.axis) : outward;
}

Heights PlacedPart::below_top(double x, double y, Heights z) const {
  const Vec3 u = pose_.axis, t = pose_.tip_mm;
  const double rest = reach_.z1_mm - (x - t.x) * u.x - (y - t.y) * u.y;  // u.z (z - t.z) <= rest
  if (u.z > 0) z.hi = std::min(z.hi, t.z + rest / u.z);
  if (u.z < 0) z.lo = std::max(z.lo, t.z + rest / u.z);
  if (u.z == 0 && rest < 0) return {1, 0};
  return z;
}

Deepest PlacedPart::least(double x, double y, Heights z, double threshold_mm,
                          double around_mm) const {
  Tangent a = tangent(x, y, z.lo), b = tangent(x, y, z.hi);
  Deepest found;
  for (int i = 0; i < kSearchSteps; ++i) {
    const bool inner = a.slope() < 0 && b.slope() > 0;
    const double width = b.z - a.z;
    const double meet = inner ? (a.mm - b.mm + b.slope() * width) / (b.slope() - a.slope()) : 0;
    const bool lower = a.mm <= b.mm;
    found = {lower ? a.mm : b.mm, lower ? a.z : b.z, false};
    // A plane below the function: the mean of the two tangent planes that is level in z.
    const double share = inner ? b.slope() / (b.slope() - a.slope()) : (a.slope() < 0 ? 0 : 1);
    const Vec3 g = a.gradient * share + b.gradient * (1 - share);
    const double middle = inner ? a.mm + a.slope() * meet : (share > 0 ? a.mm : b.mm);
    const double bound = middle - (std::abs(g.x) + std::abs(g.y)) * around_mm;
    found.pruned = bound >= -threshold_mm - kDepthEpsilonMm;
    if (found.pruned || !inner || found.outside - middle <= kDepthEpsilonMm) break;
    const Tangent c = tangent(x, y, a.z + std::clamp(meet, 0.1 * width, 0.9 * width));
    (c.slope() < 0 ? a : b) = c;
  }
  return found;
}

PlacedPart::Tangent PlacedPart::tangent(double x, double y, double z) const {
  Vec3 outward;
  const double mm = at({x, y, z}, &outward);
  return {z, mm, outward};
}

}  // namespace kerf
