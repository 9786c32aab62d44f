// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/intersect/ray_cone.h"
#include "kernel/intersect/ray_parallelogram.h"
#include "kernel/intersect/ray_pipe.h"
#include "kernel/sweep/shadow.h"
#include "kernel/tool/tool.h"

namespace kerf {

/// A truncated cone of the tool that moves without turning: exact. Between its start and its end it
/// is bounded by two parallelograms of the side and the pipes of the two rims (paper Eq. 11).
class FrustumTranslation {
 public:
  FrustumTranslation(const FrustumPiece& piece, const ToolPose& from, const ToolPose& to);

  void leave(const Trail& trail) { shadow_.leave(trail); }
  const SweepBounds& bounds() const { return shadow_.bounds(); }
  void lower_bound(const Discs& discs, Lanes& z_mm) const { shadow_.lower_bound(discs, z_mm); }
  void evaluate(ColumnBlock& block) const;

  struct Surfaces {
    RayCone start, end;
    RayParallelogram left, right;
    RayPipe lower, upper;
  };
  /// What the surfaces cover of the XY plane, in the order of Surfaces; a little more, so that no
  /// ray that meets one is outside.
  struct Rectangles {
    Lanes min_x, max_x, min_y, max_y;
  };

 private:
  Surfaces surfaces_;
  Rectangles rectangles_;
  Shadow shadow_;
};

}  // namespace kerf
