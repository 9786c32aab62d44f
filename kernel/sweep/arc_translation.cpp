// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/arc_translation.h"

#include "kernel/math/tolerance.h"
#include "kernel/piece/tool_piece.h"
#include "kernel/sweep/slice_meeting.h"

namespace kerf {
namespace {

using Surfaces = ArcTranslation::Surfaces;

/// The lane of each surface in the rectangles.
enum Surface { kStart, kEnd, kContour, kLower, kUpper };

Surfaces make_surfaces(const ArcPiece& p, const ArcPiece& whole, const ToolPose& from,
                       const ToolPose& to) {
  const Vec3 d = to.tip_mm - from.tip_mm;
  const auto rim = [&](double z) {
    return RayPipe(from.tip_mm + from.axis * z, from.axis, radius_at(p, z), d);
  };
  return {ArcSide(whole), from,        to, RayContour(p, from.tip_mm, from.axis, d),
          rim(p.z0_mm),   rim(p.z1_mm)};
}

SurfaceRectangles rectangles_of(const ArcPiece& p, const Surfaces& s, const ToolPose& from,
                                const ToolPose& to) {
  SurfaceRectangles all;
  const Extent e = extent(p);
  const auto cylinder = [&](int i, const ToolPose& pose) {
    all.include(i, pose.tip_mm + pose.axis * e.z0_mm, pose.axis, e.radius_mm);
    all.include(i, pose.tip_mm + pose.axis * e.z1_mm, pose.axis, e.radius_mm);
  };
  cylinder(kStart, from);
  cylinder(kEnd, to);
  cylinder(kContour, from);
  cylinder(kContour, to);
  all.include(kLower, s.lower);
  all.include(kUpper, s.upper);
  return all;
}

KERF_INLINE void evaluate_arc_surfaces_in_lanes(const Surfaces& s, const SurfaceRectangles& r,
                                                bool start_is_gone, ColumnBlock& block) {
  const Lanes x = block.x_mm;
  const LaneMask beside = r.beside(x[0], x[kLanes - 1]);
  for (int row = 0; row < kBlockSide; ++row) {
    if ((block.rows >> row & 1) == 0) continue;
    const unsigned over = r.over(beside, block.y_mm[row]);
    if (over == 0) continue;
    const auto may_meet = [&](Surface surface) { return (over >> surface & 1) != 0; };
    LaneSpan span;
    const Lanes y = Lanes(block.y_mm[row]);
    if (may_meet(kStart)) {
      start_is_gone ? include_gone(span, s.arc, s.from, x, y, block.grid_top_mm)
                    : include_pose(span, s.arc, s.from, x, y, block.grid_top_mm);
    }
    if (may_meet(kEnd)) include_pose(span, s.arc, s.to, x, y, block.grid_top_mm);
    if (may_meet(kContour)) s.contour.extend(span, x, y);
    if (may_meet(kLower)) s.lower.extend(span, x, y);
    if (may_meet(kUpper)) s.upper.extend(span, x, y);
    block.add(row, span.lo, span.hi);
  }
}
KERF_FOR_EACH_TARGET(void, evaluate_arc_surfaces,
                     (const Surfaces& s, const SurfaceRectangles& r, bool start_is_gone,
                      ColumnBlock& block),
                     (s, r, start_is_gone, block))

}  // namespace

ArcTranslation::ArcTranslation(const ArcPiece& p, const ArcPiece& whole, const ToolPose& from,
                               const ToolPose& to, ShownDiscs shown, const SliceSearch& search)
    : surfaces_(make_surfaces(p, whole, from, to)),
      rectangles_(rectangles_of(p, surfaces_, from, to)),
      shadow_(p, {from, to}, kEdgeEpsilonMm),
      slice_(p, whole, from, to, shown, search) {}

void ArcTranslation::evaluate(ColumnBlock& block) const {
  slice_.add_simple_rows(block);
  evaluate_arc_surfaces(surfaces_, rectangles_, start_is_gone_, block);
}

}  // namespace kerf
