// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "kernel/piece/frustum.h"
#include "kernel/sweep/column_block.h"
#include "kernel/sweep/trail.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// The outline on the XY plane of a piece that takes some poses, and from below a plane: they tell
/// which parts of the stock the piece cannot change. Both allow for `margin_mm`, how far the piece
/// may leave the hull of its poses in between.
class Shadow {
 public:
  Shadow(const FrustumPiece& envelope, const std::vector<ToolPose>& poses, double margin_mm);

  /// The piece has been removed from the stock at its first pose.
  void leave(const Trail& trail) { trail_ = trail; }

  const SweepBounds& bounds() const { return bounds_; }
  /// Lowers `z_mm` to the lowest height that is removed within each disc, where any is.
  void lower_bound(const Discs& discs, Lanes& z_mm) const;

 private:
  Lanes support_lo_, support_hi_;  ///< extent along eight directions, 22.5 degrees apart
  SweepBounds bounds_;
  /// Nothing is below z = at_origin + by_x x + by_y y; `steepness` is the plane's slope.
  struct Plane {
    double at_origin_mm, by_x, by_y, steepness;
  } plane_;
  std::optional<Trail> trail_;
};

}  // namespace kerf
