// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "kernel/piece/tool_piece.h"
#include "kernel/sweep/column_block.h"
#include "kernel/sweep/level_bound.h"
#include "kernel/sweep/trail.h"
#include "kernel/sweep/underside.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// Bounds of a slice at several poses of a motion: its outline in the XY plane, and planes below
/// it. The slice cannot change parts of the stock outside of them. The outline is enlarged by
/// `margin_mm`, the distance by which the slice may leave the hull of its poses in between.
class Shadow {
 public:
  Shadow(const ToolPiece& slice, const std::vector<ToolPose>& poses, double margin_mm);

  /// Must be called if the piece at its first pose has already been removed from the stock. The
  /// region behind the piece is then excluded too.
  void set_trail(const Trail& trail);

  const SweepBounds& bounds() const { return bounds_; }
  /// Lowers `z_mm` to a lower bound of the heights that the slice sweeps within each disc.
  LeftOut lower_bound(const Discs& discs, Lanes& z_mm) const;

 private:
  Lanes support_lo_, support_hi_;  ///< extent along eight directions, 22.5 degrees apart
  SweepBounds bounds_;
  /// The piece is above z = at_origin + by_x x + by_y y; `steepness` is the plane's slope.
  struct Plane {
    double at_origin_mm, by_x, by_y, steepness;
  } plane_;
  Underside underside_;
  std::optional<Trail> trail_;
  std::optional<LevelBound> level_;  ///< replaces all other bounds if set
};

}  // namespace kerf
