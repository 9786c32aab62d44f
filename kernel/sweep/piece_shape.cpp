#include "kernel/sweep/piece_shape.h"

#include <algorithm>
#include <cmath>

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

Envelope envelope_of(const ToolPiece& piece) { return std::visit(EnvelopeOf{}, piece); }

ToolPiece slice_of(const ToolPiece& piece, double z0_mm, double z1_mm) {
  if (const auto* arc = std::get_if<ArcPiece>(&piece)) {
    return ArcPiece{arc->center_r_mm, arc->center_z_mm, arc->radius_mm, z0_mm, z1_mm};
  }
  const auto& f = std::get<FrustumPiece>(piece);
  return FrustumPiece{z0_mm, Radius{z0_mm}(f), z1_mm, Radius{z1_mm}(f)};
}

std::optional<ToolPiece> clip_below(const ToolPiece& piece, const ToolMotion& m, double top_mm) {
  // Along a great circle within the upper half the axis leans most at one of its ends, and the tip
  // is lowest at one of its ends.
  const double uz = std::min(m.from.axis.z, m.to.axis.z);
  const double tip_z = std::min(m.from.tip_mm.z, m.to.tip_mm.z);
  if (!(uz > 0)) return piece;
  if (const auto* ball = std::get_if<BallPiece>(&piece)) {
    const double lowest = tip_z + uz * ball->center_mm - ball->radius_mm;
    return lowest > top_mm ? std::nullopt : std::optional(piece);
  }
  const Envelope e = envelope_of(piece);
  const double lean = std::sqrt(std::max(0.0, 1 - uz * uz));
  const double reach = (top_mm - tip_z + std::max(e.r_lo_mm, e.r_hi_mm) * lean) / uz;
  const double needed = reach + 1e-3 * (e.hi_mm - e.lo_mm);  // Well clear of the block's top.
  if (reach <= e.lo_mm) return std::nullopt;
  return needed < e.hi_mm ? slice_of(piece, e.lo_mm, needed) : piece;
}

}  // namespace kerf
