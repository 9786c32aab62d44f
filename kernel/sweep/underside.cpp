// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/underside.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Least vertical component of the axis, and of a plane's normal, for a bound.
constexpr double kUnderAxisMin = 0.3, kFacingMin = 0.1;

/// A direction of the slice for each disc: the normal is e cosine + u sine, and no point of the
/// slice is farther than `support` along it.
struct Normals {
  Vec3Lanes e;
  Lanes cosine, sine, support;
};

/// Returns normals of the side that face down, below the nearest position of each disc.
KERF_INLINE Normals normals_of(const Underside::Motion& m, Lanes dx, Lanes dy, double reach) {
  const Lanes rx = dx - m.middle * m.u.x, ry = dy - m.middle * m.u.y;
  const Lanes rz = (rx * m.u.x + ry * m.u.y) * (-1 / m.u.z);
  const Lanes off = square_root(rx * rx + ry * ry + rz * rz);
  const Lanes scale = select(off > 0.0, 1 / off, Lanes(0));
  Normals n;
  n.e = {rx * scale, ry * scale, rz * scale};
  if (!m.is_arc) {
    n.cosine = Lanes(m.cosine);
    n.sine = Lanes(m.sine);
    n.support = Lanes(m.support);
    return n;
  }
  const Lanes across = (off - (m.center_r + reach)) * (1 / m.radius);
  n.cosine = lesser(greater(across, Lanes(0)), Lanes(1));
  n.sine = -square_root(1 - n.cosine * n.cosine);
  n.support = n.cosine * m.center_r + n.sine * m.middle + m.radius;
  return n;
}

KERF_INLINE void raise_bound_in_lanes(const Underside::Motion& m, const Discs& discs, Lanes& z) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double reach = discs.reach_mm;
  const Lanes dx = discs.x_mm - m.tip.x, dy = discs.y_mm - m.tip.y;
  const Normals n = normals_of(m, dx, dy, reach);
  const Lanes by_turn = n.e.x * m.w.x + n.e.y * m.w.y + n.e.z * m.w.z;
  Lanes disc = Lanes(kInfinity), side = Lanes(kInfinity);
  for (int i = 0; i < m.stations; ++i) {
    const Underside::Station& s = m.station[i];
    disc = lesser(s.at_origin + dx * s.by_x + dy * s.by_y - s.steepness * reach, disc);
    const Lanes nx = (n.e.x + by_turn * s.turned.x) * n.cosine + n.sine * s.u.x;
    const Lanes ny = (n.e.y + by_turn * s.turned.y) * n.cosine + n.sine * s.u.y;
    const Lanes nz = (n.e.z + by_turn * s.turned.z) * n.cosine + n.sine * s.u.z;
    const Lanes beyond = nx * (dx - s.tip.x) + ny * (dy - s.tip.y) -
                         square_root(nx * nx + ny * ny) * reach - (n.support + m.margin);
    const Lanes height = s.tip.z - beyond / nz;
    side = select(nz < -kFacingMin, lesser(height, side), Lanes(-kInfinity));
  }
  z = greater(greater(disc, side) + m.tip.z, z);
}
KERF_FOR_EACH_TARGET(void, raise_bound, (const Underside::Motion& m, const Discs& discs, Lanes& z),
                     (m, discs, z))

}  // namespace

Underside::Underside(const ToolPiece& slice, const ToolPose& from, const ToolPose& to) {
  const TurningFrame f(from, to);
  const Extent e = extent(slice);
  m_.tip = f.tip;
  m_.u = f.u;
  m_.w = f.w;
  m_.leans_little = std::min({f.u.z, from.axis.z, to.axis.z}) > kUnderAxisMin;
  if (!m_.leans_little) return;
  const auto* arc = std::get_if<ArcPiece>(&slice);
  m_.is_arc = arc != nullptr;
  if (arc != nullptr) {
    m_.middle = arc->center_z_mm;
    m_.center_r = arc->center_r_mm;
    m_.radius = arc->radius_mm;
  } else {
    const FrustumSide side(std::get<FrustumPiece>(slice));
    m_.middle = e.z0_mm;
    m_.cosine = side.cosine;
    m_.sine = -side.slope * side.cosine;
    m_.support = m_.cosine * side.r0_mm + m_.sine * e.z0_mm;
  }
  const double travel = length(f.v);
  const double reach = std::sqrt(e.z1_mm * e.z1_mm + e.radius_mm * e.radius_mm) + travel;
  const double bend = f.turn * f.turn * reach + 2 * f.turn * travel;
  int steps = 1;
  while (steps < kStationsMax - 1 && bend / (8 * steps * steps) > kUndersideSlackMm) steps *= 2;
  m_.margin = bend / (8 * steps * steps) + kEdgeEpsilonMm;
  m_.stations = steps + 1;
  for (int i = 0; i <= steps; ++i) {
    const double share = double(i) / steps;
    const TurningFrame::Poses pose = f.at(Lanes(share));
    Station& s = m_.station[i];
    s.tip = {pose.tip.x[0], pose.tip.y[0], pose.tip.z[0]};
    s.u = {pose.u.x[0], pose.u.y[0], pose.u.z[0]};
    s.turned = f.turn > 0 ? cross(f.k, s.u) - f.w : Vec3{};
    const double inverse = 1 / s.u.z;
    s.at_origin = (dot(s.u, s.tip) + e.z0_mm - m_.margin) * inverse;
    s.by_x = -s.u.x * inverse;
    s.by_y = -s.u.y * inverse;
    s.steepness = std::sqrt(s.by_x * s.by_x + s.by_y * s.by_y);
  }
}

void Underside::raise(const Discs& discs, Lanes& z_mm) const {
  if (m_.leans_little) raise_bound(m_, discs, z_mm);
}

}  // namespace kerf
