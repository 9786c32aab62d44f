// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sweep/moving_slice.h"
#include "kernel/sweep/shadow.h"

namespace kerf {

/// Sweep of a slice of the tool (frustum or arc) along the true motion between two poses whose axes
/// are less than kTurnPerFrameMaxRad apart. At `parts` + 1 stations its ends on a ray are exact.
/// Between two stations the share at which an end is outermost is searched (kernel/sweep/README.md,
/// "The tight model").
class TurningSweep {
 public:
  /// `slice` is a frustum or an arc, the part of `whole` that can reach into the block. `shown` has
  /// its discs that are not hidden within neighbors.
  TurningSweep(const ToolPiece& slice, const ToolPiece& whole, const ToolPose& from,
               const ToolPose& to, ShownDiscs shown, const SliceSearch& search);

  /// See Shadow::set_trail.
  void set_trail(const Trail& trail) { shadow_.set_trail(trail); }
  const SweepBounds& bounds() const { return shadow_.bounds(); }
  LeftOut lower_bound(const Discs& discs, Lanes& z_mm) const {
    return shadow_.lower_bound(discs, z_mm);
  }
  /// See MovingSlice. The rows that are not simple need the heights of the stock.
  RowBits add_simple_rows(ColumnBlock& block) const { return slice_.add_simple_rows(block); }
  void evaluate(const RowBits& known, ColumnBlock& block) const { slice_.evaluate(known, block); }
  void evaluate(ColumnBlock& block) const { slice_.evaluate(block); }

 private:
  MovingSlice slice_;
  Shadow shadow_;
};

}  // namespace kerf
