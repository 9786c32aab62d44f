// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/frustum_translation.h"

#include <algorithm>
#include <cmath>

#include "kernel/math/tolerance.h"
#include "kernel/sweep/slice_meeting.h"

namespace kerf {
namespace {

using Surfaces = FrustumTranslation::Surfaces;

/// The two generators of the side along which n·V = 0 (paper Eqs. 1–8, with cosines instead of
/// angles): radial directions e with (e − k u)·d = 0. `exist` is false if the whole side advances
/// or recedes, |k d·u| > |d⊥|.
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

Surfaces make_surfaces(const FrustumPiece& piece, const FrustumPiece& whole, const ToolPose& from,
                       const ToolPose& to) {
  const Vec3 base = from.tip_mm + from.axis * piece.z0_mm, d = to.tip_mm - from.tip_mm;
  const double slope = kerf::slope(piece), height = piece.z1_mm - piece.z0_mm;
  const CuttingProfile profile = cutting_profile(from.axis, slope, d);
  const auto side = [&](Vec3 e) {
    // Without a cutting profile the parallelogram is degenerate and never hit.
    if (!profile.exist) return RayParallelogram(base, {}, {});
    return RayParallelogram(base + e * piece.r0_mm, (from.axis + e * slope) * height, d);
  };
  return {ConeSide(whole),
          from,
          to,
          side(profile.radial[0]),
          side(profile.radial[1]),
          RayPipe(base, from.axis, piece.r0_mm, d),
          RayPipe(base + from.axis * height, from.axis, piece.r1_mm, d)};
}

/// The lane of each surface in the rectangles.
enum Surface { kStart, kEnd, kLeft, kRight, kLower, kUpper };

SurfaceRectangles rectangles_of(const FrustumPiece& piece, const Surfaces& s) {
  SurfaceRectangles all;
  const auto cone = [&](int i, const ToolPose& pose) {
    all.include(i, pose.tip_mm + pose.axis * piece.z0_mm, pose.axis, piece.r0_mm);
    all.include(i, pose.tip_mm + pose.axis * piece.z1_mm, pose.axis, piece.r1_mm);
  };
  const auto parallelogram = [&](int i, const RayParallelogram& p) {
    for (const Vec3& corner :
         {p.corner, p.corner + p.side, p.corner + p.along, p.corner + p.side + p.along}) {
      all.include(i, corner, {}, 0);
    }
  };
  cone(kStart, s.from);
  cone(kEnd, s.to);
  parallelogram(kLeft, s.left);
  parallelogram(kRight, s.right);
  all.include(kLower, s.lower);
  all.include(kUpper, s.upper);
  return all;
}

KERF_INLINE void evaluate_surfaces_in_lanes(const Surfaces& s, const SurfaceRectangles& r,
                                            bool start_is_gone, ColumnBlock& block) {
  const Lanes x = block.x_mm;
  const LaneMask beside = r.beside(x[0], x[kLanes - 1]);
  for (int row = 0; row < kBlockSide; ++row) {
    if ((block.rows >> row & 1) == 0) continue;
    const double row_y = block.y_mm[row];
    const unsigned over = r.over(beside, row_y);
    if (over == 0) continue;
    const auto may_meet = [&](Surface surface) { return (over >> surface & 1) != 0; };
    LaneSpan span;
    const Lanes y = Lanes(row_y);
    if (may_meet(kStart)) {
      start_is_gone ? include_gone(span, s.cone, s.from, x, y, block.grid_top_mm)
                    : include_pose(span, s.cone, s.from, x, y, block.grid_top_mm);
    }
    if (may_meet(kEnd)) include_pose(span, s.cone, s.to, x, y, block.grid_top_mm);
    if (may_meet(kLeft)) s.left.extend(span, x, y);
    if (may_meet(kRight)) s.right.extend(span, x, y);
    if (may_meet(kLower)) s.lower.extend(span, x, y);
    if (may_meet(kUpper)) s.upper.extend(span, x, y);
    block.add(row, span.lo, span.hi);
  }
}
KERF_FOR_EACH_TARGET(void, evaluate_surfaces,
                     (const Surfaces& s, const SurfaceRectangles& r, bool start_is_gone,
                      ColumnBlock& block),
                     (s, r, start_is_gone, block))

}  // namespace

FrustumTranslation::FrustumTranslation(const FrustumPiece& p, const FrustumPiece& whole,
                                       const ToolPose& from, const ToolPose& to, ShownDiscs shown,
                                       const SliceSearch& search)
    : surfaces_(make_surfaces(p, whole, from, to)),
      rectangles_(rectangles_of(p, surfaces_)),
      shadow_(p, {from, to}, kEdgeEpsilonMm),
      slice_(p, whole, from, to, shown, search) {}

void FrustumTranslation::evaluate(ColumnBlock& block) const {
  slice_.add_simple_rows(block);
  evaluate_surfaces(surfaces_, rectangles_, start_is_gone_, block);
}

}  // namespace kerf
