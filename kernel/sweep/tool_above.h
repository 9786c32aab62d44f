// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "kernel/sweep/column_block.h"
#include "kernel/sweep/tool_motion.h"
#include "kernel/tool/tool.h"

namespace kerf {

/// The upright cylinder that the tool contains above one of its pieces, during a motion. The piece
/// up to the cylinder's foot and the cylinder form a convex body, so a ray that is inside the
/// cylinder at the top of the grid loses everything above a point that the piece reaches
/// (kernel/sweep/bounds.md, "Below the tool's own body").
class ToolAbove {
 public:
  /// Covers nothing.
  ToolAbove() = default;
  /// The tool's piece `which` moves along `motion`, which turns by less than kTurnPerFrameMaxRad.
  /// `top_mm` is the top of the grid.
  ToolAbove(const Tool& tool, std::size_t which, const ToolMotion& motion, double top_mm);

  bool covers_any() const { return radius_ > 0; }
  /// Sets `raised` of the rows `block.rows` to the columns that are inside the cylinder at the top
  /// of the grid during the whole motion.
  void find_covered(ColumnBlock& block) const;

  /// The pose at one end of the motion.
  struct Pose {
    double x, y;  ///< of the tip
    double z;     ///< height of the top of the grid above the tip
    Vec3 axis;
  };

 private:
  Pose poses_[2];
  double low_ = 0, high_ = 0;  ///< heights of the cylinder on the axis, narrowed by the margin
  double radius_ = 0;          ///< narrowed likewise; 0 without a cylinder
};

}  // namespace kerf
