// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/piece/frustum.h"
#include "kernel/sweep/column_block.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// Where a truncated cone of a tool cannot remove anything during a motion, because it has been
/// removed from the stock at the motion's first pose and nothing of its side over that part of the
/// plane moves outwards afterwards: behind the tool. It costs little beside the sweep itself.
class Trail {
 public:
  /// The slice moves from one pose to the other; their axes are less than kTurnPerFrameMaxRad
  /// apart. `shows_edge`: a disc of the slice is not hidden within its neighbours, or its
  /// side makes an edge with theirs. What that does is left to the sweep.
  Trail(const FrustumPiece& slice, const ToolPose& from, const ToolPose& to, bool shows_edge);

  /// Bit i is set where nothing is removed over disc i.
  unsigned behind(const Discs& discs) const;

  /// What the test needs, in the middle of the motion; n·V of a point of the side q from the axis,
  /// times the radius, is q·v′ less `climb` there, v′ = v + m w, m = m0 + m1 l.
  struct Motion {
    Vec3 tip, axis, v, w;
    double low, high;  ///< heights of the slice
    double m0, m1, climb0, climb1;
    double radius, lean;  ///< greatest radius; sine of the angle between axis and rays
    double level, level_min, level_max;  ///< of the axis seen from above; least and greatest
    double aside;                  ///< of the side from the axis, along the axis seen from above
    double half_way;               ///< of the tip, seen from above
    double level_speed;            ///< greatest of v′, seen from above
    double bend;                   ///< of q·v′ between two heights, per mm²
    double margin, margin_per_mm;  ///< by how much n·V may change until the ends, and over a disc
    bool whole;  ///< a place on the plane may have any height of the slice over it
    bool shows_edge;
  };

 private:
  Motion m_;
};

}  // namespace kerf
