// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/moving_slice.h"

#include <algorithm>
#include <cmath>

#include "kernel/sweep/turning_rows.h"

namespace kerf {
namespace {

PieceSide side_of(const ToolPiece& slice) {
  if (const auto* arc = std::get_if<ArcPiece>(&slice)) return ArcSide(*arc);
  return ConeSide(std::get<FrustumPiece>(slice));
}

/// Returns the distance from the tip that encloses the slice.
double upper_reach(const Extent& e) {
  return std::sqrt(e.z1_mm * e.z1_mm + e.radius_mm * e.radius_mm);
}

SlicePath make_path(const Extent& e, const ToolPose& from, const ToolPose& to,
                    const SliceSearch& search) {
  const TurningFrame frame(from, to);
  const double reach = upper_reach(e);
  const double speed = length(frame.v) + frame.turn * reach;
  return {frame,
          search,
          reach,
          speed > 0 ? speed : 1,
          0,
          {},
          frame.placed(Lanes(0)),
          frame.placed(Lanes(1))};
}

/// Greatest number of parts whose stations are kept in a DiscPath, and least vertical component of
/// the axis there.
constexpr int kDiscPartsMax = 16;
constexpr double kDiscUprightMin = 0.3;

DiscPose disc_pose(const TurningFrame& frame, double anchor, const DiscPlanes& discs,
                   double share) {
  const TurningFrame::Poses at = frame.placed(Lanes(share));
  const Vec3 u{at.u.x[0], at.u.y[0], at.u.z[0]}, tip{at.tip.x[0], at.tip.y[0], at.tip.z[0]};
  return {tip + u * anchor, u, 1 / u.z, dot(u, frame.v), cross(u, frame.k * frame.turn), discs};
}

DiscPath disc_path(const DiscPlanes& discs, double anchor, const SlicePath& path) {
  DiscPath result;
  const TurningFrame& f = path.frame;
  result.least_uz = f.u.z - f.turn;
  result.anchor = anchor;
  if (!(result.least_uz > kDiscUprightMin)) return result;
  const int parts = path.search.parts;
  for (int i = parts <= kDiscPartsMax ? 0 : parts; i <= parts; ++i) {
    result.poses.push_back(disc_pose(f, anchor, discs, double(i) / parts));
  }
  return result;
}

/// Returns discs that enclose the rows of a block.
Discs rows_of(const ColumnBlock& block) {
  const double first = block.x_mm[0], last = block.x_mm[kLanes - 1];
  Discs discs{Lanes((first + last) * 0.5), {}, (last - first) * 0.5};
  for (int row = 0; row < kBlockSide; ++row) discs.y_mm.set(row, block.y_mm[row]);
  return discs;
}

}  // namespace

MovingSlice::MovingSlice(const ToolPiece& slice, const ToolPose& from, const ToolPose& to,
                         ShownDiscs shown, const SliceSearch& search)
    : MovingSlice(slice, slice, from, to, shown, search) {}

MovingSlice::MovingSlice(const ToolPiece& slice, const ToolPiece& whole, const ToolPose& from,
                         const ToolPose& to, ShownDiscs shown, const SliceSearch& search)
    : side_(side_of(whole)),
      path_(make_path(extent(slice), from, to, search)),
      shown_(shown),
      ahead_(slice, to, from, {true, !shown.upper_is_outside}) {
  std::visit([this](const auto& side) { path_.discs = disc_path(side.planes, side.anchor, path_); },
             side_);
}

RowBits MovingSlice::know(const ColumnBlock& block) const {
  UntestedDiscs hidden;
  if (!shown_.lower) hidden.lower = block.below_is_swept;
  if (!shown_.upper) hidden.upper = shown_.upper_is_outside ? 0xFF : block.above_is_swept;
  RowBits known;
  const bool rests = path_.frame.from == path_.frame.to;
  known.ahead = rests ? block.rows : ahead_.behind(rows_of(block), hidden) & block.rows;
  const double uz = path_.frame.u.z, turn = path_.frame.turn;
  if (uz > turn) {
    known.hides_entry = hidden.lower;
    known.hides_exit = hidden.upper;
  } else if (uz < -turn) {
    known.hides_entry = hidden.upper;
    known.hides_exit = hidden.lower;
  }
  return known;
}

RowBits MovingSlice::add_simple_rows(ColumnBlock& block) const {
  const RowBits known = know(block);
  add_simple_rows_of_slice(side_, path_, known, block);
  return known;
}

void MovingSlice::evaluate(const RowBits& known, ColumnBlock& block) const {
  if (block.rows != 0) evaluate_slice(side_, path_, known, block);
}

}  // namespace kerf
