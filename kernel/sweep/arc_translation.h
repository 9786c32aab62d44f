// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/intersect/ray_contour.h"
#include "kernel/intersect/ray_pipe.h"
#include "kernel/sweep/moving_slice.h"
#include "kernel/sweep/shadow.h"
#include "kernel/sweep/surface_rectangles.h"

namespace kerf {

/// Exact sweep of an arc piece that moves without turning. Between its start and its end it is
/// bounded by the swept contour of its side and by the pipes of its two rims (paper Eq. 11).
class ArcTranslation {
 public:
  /// `piece` is the part of `whole` that can reach into the block. `shown` has the discs of the
  /// piece that are not hidden within its neighbors.
  ArcTranslation(const ArcPiece& piece, const ArcPiece& whole, const ToolPose& from,
                 const ToolPose& to, ShownDiscs shown, const SliceSearch& search);

  /// See Shadow::set_trail.
  void set_trail(const Trail& trail) {
    shadow_.set_trail(trail);
    start_is_gone_ = true;
  }
  const SweepBounds& bounds() const { return shadow_.bounds(); }
  LeftOut lower_bound(const Discs& discs, Lanes& z_mm) const {
    return shadow_.lower_bound(discs, z_mm);
  }
  void evaluate(ColumnBlock& block) const;

  struct Surfaces {
    ArcSide arc;
    ToolPose from, to;
    RayContour contour;
    RayPipe lower, upper;
  };

 private:
  Surfaces surfaces_;
  SurfaceRectangles rectangles_;
  Shadow shadow_;
  MovingSlice slice_;
  bool start_is_gone_ = false;
};

}  // namespace kerf
