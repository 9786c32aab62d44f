#include "kernel/sweep/frustum_translation.h"

#include <cmath>

namespace kerf {
namespace {

using Surfaces = FrustumTranslation::Surfaces;

RayCone at_pose(const FrustumPiece& p, const ToolPose& pose) {
  return {pose.tip_mm + pose.axis * p.z0_mm, pose.axis, p.z1_mm - p.z0_mm, p.r0_mm, p.r1_mm};
}

/// The two generators of the side along which n·V = 0 (paper Eqs. 1–8, with cosines instead of
/// angles): radial directions e with (e − k u)·d = 0. None where the whole side is lit or dark, |k
/// d·u| > |d⊥|: `exist` is false.
struct CuttingProfile {
  Vec3 radial[2];
  bool exist;
};

CuttingProfile cutting_profile(Vec3 u, double slope, Vec3 d) {
  const double du = dot(d, u);
  const Vec3 across = d - u * du;
  const double n = length(across);
  const double cosine = slope * du / n;
  if (!(std::abs(cosine) <= 1)) return {{}, false};
  const Vec3 a = across * (1 / n);
  const Vec3 b = cross(u, a);
  const double sine = std::sqrt(1 - cosine * cosine);
  return {{a * cosine + b * sine, a * cosine - b * sine}, true};
}

Surfaces make_surfaces(const FrustumPiece& piece, const ToolPose& from, const ToolPose& to) {
  const RayCone start = at_pose(piece, from);
  const Vec3 d = to.tip_mm - from.tip_mm;
  const CuttingProfile profile = cutting_profile(start.axis, start.slope, d);
  const auto side = [&](Vec3 e) {
    // Without a cutting profile the parallelogram collapses and is met nowhere.
    if (!profile.exist) return RayParallelogram(start.base, {}, {});
    return RayParallelogram(start.base + e * start.r0,
                            (start.axis + e * start.slope) * start.height, d);
  };
  return {start,
          at_pose(piece, to),
          side(profile.radial[0]),
          side(profile.radial[1]),
          RayPipe(start.base, start.axis, piece.r0_mm, d),
          RayPipe(start.base + start.axis * start.height, start.axis, piece.r1_mm, d)};
}

KERF_INLINE void evaluate_surfaces_in_lanes(const Surfaces& s, ColumnBlock& block) {
  for (int row = 0; row < kBlockSide; ++row) {
    if ((block.rows >> row & 1) == 0) continue;
    LaneSpan span;
    const Lanes x = block.x_mm, y = Lanes(block.y_mm[row]);
    s.start.extend(span, x, y);
    s.end.extend(span, x, y);
    s.left.extend(span, x, y);
    s.right.extend(span, x, y);
    s.lower.extend(span, x, y);
    s.upper.extend(span, x, y);
    block.add(row, span.lo, span.hi);
  }
}
KERF_FOR_EACH_TARGET(void, evaluate_surfaces, (const Surfaces& s, ColumnBlock& block), (s, block))

}  // namespace

FrustumTranslation::FrustumTranslation(const FrustumPiece& p, const ToolPose& from,
                                       const ToolPose& to)
    : surfaces_(make_surfaces(p, from, to)),
      shadow_({p.z0_mm, p.r0_mm, p.z1_mm, p.r1_mm}, {from, to}, kEdgeEpsilonMm) {}

void FrustumTranslation::evaluate(ColumnBlock& block) const { evaluate_surfaces(surfaces_, block); }

}  // namespace kerf
