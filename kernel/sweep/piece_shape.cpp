// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/piece_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf {
namespace {

double side_of_circle(double center_r, double radius, double off) {
  const double h2 = radius * radius - off * off;
  return h2 < 0 ? -1 : center_r + std::sqrt(h2);
}

struct Radius {
  double z;
  double operator()(const BallPiece& p) const {
    return side_of_circle(0, p.radius_mm, z - p.center_mm);
  }
  double operator()(const FrustumPiece& p) const {
    if (z < p.z0_mm || z > p.z1_mm) return -1;
    return p.r0_mm + (p.r1_mm - p.r0_mm) * ((z - p.z0_mm) / (p.z1_mm - p.z0_mm));
  }
  double operator()(const ArcPiece& p) const {
    if (z < p.z0_mm || z > p.z1_mm) return -1;
    return side_of_circle(p.center_r_mm, p.radius_mm, z - p.center_z_mm);
  }
};

double slope_of_circle(double radius, double off) {
  return -off / std::sqrt(std::max(0.0, radius * radius - off * off));
}

struct Slope {
  double z;
  double operator()(const BallPiece& p) const {
    return slope_of_circle(p.radius_mm, z - p.center_mm);
  }
  double operator()(const FrustumPiece& p) const {
    return (p.r1_mm - p.r0_mm) / (p.z1_mm - p.z0_mm);
  }
  double operator()(const ArcPiece& p) const {
    return slope_of_circle(p.radius_mm, z - p.center_z_mm);
  }
};

struct EnvelopeOf {
  Envelope operator()(const BallPiece& p) const {
    return {p.center_mm - p.radius_mm, p.radius_mm, p.center_mm + p.radius_mm, p.radius_mm};
  }
  Envelope operator()(const FrustumPiece& p) const { return {p.z0_mm, p.r0_mm, p.z1_mm, p.r1_mm}; }
  Envelope operator()(const ArcPiece& p) const {
    const double widest = Radius{std::clamp(p.center_z_mm, p.z0_mm, p.z1_mm)}(p);
    return {p.z0_mm, widest, p.z1_mm, widest};
  }
};

}  // namespace

double radius_at(const ToolPiece& piece, double z_mm) { return std::visit(Radius{z_mm}, piece); }

double slope_at(const ToolPiece& piece, double z_mm) { return std::visit(Slope{z_mm}, piece); }

Envelope envelope_of(const ToolPiece& piece) { return std::visit(EnvelopeOf{}, piece); }

ToolPiece slice_of(const ToolPiece& piece, double z0_mm, double z1_mm) {
  if (const auto* arc = std::get_if<ArcPiece>(&piece)) {
    return ArcPiece{arc->center_r_mm, arc->center_z_mm, arc->radius_mm, z0_mm, z1_mm};
  }
  const auto& f = std::get<FrustumPiece>(piece);
  return FrustumPiece{z0_mm, Radius{z0_mm}(f), z1_mm, Radius{z1_mm}(f)};
}

std::optional<ToolPiece> clip_to_block(const ToolPiece& piece, const ToolMotion& m,
                                       const SweepBounds& block) {
  const Envelope whole = envelope_of(piece);
  const double radius = std::max(whole.r_lo_mm, whole.r_hi_mm);
  double reach = std::numeric_limits<double>::infinity();
  // `u` and `tip` are the least components of the axis and the tip along one of the six directions
  // out of the block, `limit` is the block's greatest. Along a great circle on the upper side of a
  // plane the axis leans most at one of its ends, and the tip is lowest at one of its ends.
  const auto clip = [&](double u, double tip, double limit) {
    if (!(u > 0)) return;
    const double lean = std::sqrt(std::max(0.0, 1 - u * u));
    reach = std::min(reach, (limit - tip + radius * lean) / u);
  };
  const ToolPose &a = m.from, &b = m.to;
  for (const auto c : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    clip(std::min(a.axis.*c, b.axis.*c), std::min(a.tip_mm.*c, b.tip_mm.*c), block.max_mm.*c);
    clip(-std::max(a.axis.*c, b.axis.*c), -std::max(a.tip_mm.*c, b.tip_mm.*c), -block.min_mm.*c);
  }
  if (reach <= whole.lo_mm) return std::nullopt;
  const double needed = reach + 1e-3 * (whole.hi_mm - whole.lo_mm);  // Well clear of the block.
  if (std::holds_alternative<BallPiece>(piece) || !(needed < whole.hi_mm)) return piece;
  return slice_of(piece, whole.lo_mm, needed);
}

}  // namespace kerf
