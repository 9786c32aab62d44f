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

}  // namespace

/// The points of a group in the tool's half-plane. A unit vector (a, b) of the half-plane has the
/// component a · radial_z + b · axis_z along the rays.
struct SurfaceWeight::Lanes {
  double rho[GroupPoints::kLanes], h[GroupPoints::kLanes], radial_z[GroupPoints::kLanes];
  double axis_z;
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
    for (const Piece& other : pieces_) {
      if (&other == &p) continue;
      p.covered_below = std::max(p.covered_below, other.radius_at(p.z0));
      p.covered_above = std::max(p.covered_above, other.radius_at(p.z1));
    }
    if (p.covered_below > p.radius_at(p.z0) - kCoverEpsilonMm) p.covered_below = kInfinity;
    if (p.covered_above > p.radius_at(p.z1) - kCoverEpsilonMm) p.covered_above = kInfinity;
  }
}

/// Where a piece is nearer than what was found before (less far outside, or deeper around the
/// point), takes its distance and its normal's component along the rays.
inline __attribute__((always_inline)) void SurfaceWeight::nearest_of(const Piece& p,
                                                                     const Lanes& at,
                                                                     double* nearest,
                                                                     double* normal_z) {
  for (int c = 0; c < GroupPoints::kLanes; ++c) {
    const double below = p.z0 - at.h[c], above = at.h[c] - p.z1;
    double face, n;  // signed distance from the side, and its normal along the rays
    if (p.side == Side::kLine) {
      face = (at.rho[c] - p.r0 - p.slope * (at.h[c] - p.z0)) * p.normal_r;
      n = (at.radial_z[c] - p.slope * at.axis_z) * p.normal_r;
    } else {
      const double out = at.rho[c] > p.center_r ? at.rho[c] - p.center_r : 0;
      const double up = at.h[c] - p.center_z;
      const double d = std::sqrt(out * out + up * up);
      face = d - p.radius;
      const double inverse = d > 0 ? 1 / d : 0;
      n = (out * at.radial_z[c] + up * at.axis_z) * inverse;
    }
    double distance = face > below ? face : below;
    distance = distance > above ? distance : above;
    const bool lower = at.rho[c] > p.covered_below && below > face;
    face = lower ? below : face;
    const bool upper = at.rho[c] > p.covered_above && above > face;
    n = lower ? -at.axis_z : n;
    n = upper ? at.axis_z : n;
    const bool nearer = distance < nearest[c];
    nearest[c] = nearer ? distance : nearest[c];
    normal_z[c] = nearer ? n : normal_z[c];
  }
}

KERF_VECTOR_CLONES
void SurfaceWeight::evaluate(const GroupPoints& points, Vec3 axis, double* weight) const {
  Lanes at;
  at.axis_z = axis.z;
  double nearest[GroupPoints::kLanes], normal_z[GroupPoints::kLanes];
  for (int c = 0; c < GroupPoints::kLanes; ++c) {
    const double x = points.x[c], y = points.y, z = points.z[c];
    const double h = x * axis.x + y * axis.y + z * axis.z;
    const double qx = x - h * axis.x, qy = y - h * axis.y, qz = z - h * axis.z;
    const double rho = std::sqrt(qx * qx + qy * qy + qz * qz);
    at.h[c] = h;
    at.rho[c] = rho;
    at.radial_z[c] = rho > 0 ? qz / rho : 0;
    nearest[c] = kInfinity;
    normal_z[c] = 0;
  }
  for (const Piece& p : pieces_) nearest_of(p, at, nearest, normal_z);
  for (int c = 0; c < GroupPoints::kLanes; ++c) weight[c] = normal_z[c] * normal_z[c];
}

}  // namespace kerf
