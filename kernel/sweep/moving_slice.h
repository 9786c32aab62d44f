// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sweep/column_block.h"
#include "kernel/sweep/piece_side.h"
#include "kernel/sweep/slice_path.h"
#include "kernel/sweep/trail.h"

namespace kerf {

/// A slice of the tool (frustum or arc) that moves between two poses whose axes are less than
/// kTurnPerFrameMaxRad apart. Adds the intervals that it removes to the rows of a block, and finds
/// the rows that need no search.
class MovingSlice {
 public:
  /// `shown` has the discs of the slice that are not hidden within its neighbors. Ends on hidden
  /// discs are left to the neighbors, in rows in which these are swept too.
  MovingSlice(const ToolPiece& slice, const ToolPose& from, const ToolPose& to, ShownDiscs shown,
              const SliceSearch& search);
  /// As above, for a slice that is the part of `whole` that can reach into the block. No ray of the
  /// block meets the rest.
  MovingSlice(const ToolPiece& slice, const ToolPiece& whole, const ToolPose& from,
              const ToolPose& to, ShownDiscs shown, const SliceSearch& search);

  const SlicePath& path() const { return path_; }
  /// Sets a lower bound of the slice's heights (mm).
  void set_lowest(double z_mm) { path_.lowest_mm = z_mm; }

  /// Adds the intervals of the rows of a block that are ahead of the slice, where its last pose is
  /// all that it sweeps, and of those whose rays all cross its discs (kernel/sweep/bounds.md,
  /// "Ahead of a tool", "Rays through the discs"). Removes these rows from those to be evaluated.
  RowBits add_simple_rows(ColumnBlock& block) const;
  /// Adds the intervals of the remaining rows, with searches where needed. `known` is the result of
  /// add_simple_rows.
  void evaluate(const RowBits& known, ColumnBlock& block) const;
  /// Adds the intervals of all rows.
  void evaluate(ColumnBlock& block) const { evaluate(add_simple_rows(block), block); }

 private:
  RowBits know(const ColumnBlock& block) const;

  PieceSide side_;
  SlicePath path_;
  ShownDiscs shown_;
  Trail ahead_;  ///< of the reversed motion
};

}  // namespace kerf
