// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/piece/frustum.h"
#include "kernel/sweep/column_block.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// Conservative test for regions behind a moving frustum. There n·V < 0 on its whole side during
/// the motion, and the frustum at the first pose has been removed from the stock already, so
/// nothing more is removed. The test is cheap compared with the sweep.
class Trail {
 public:
  /// The slice moves from one pose to the other; their axes are less than kTurnPerFrameMaxRad
  /// apart. `shows_edge`: a disc of the slice is not hidden within its neighbors, or its side makes
  /// an edge with theirs. Regions that such an edge may reach are never reported as behind.
  Trail(const FrustumPiece& slice, const ToolPose& from, const ToolPose& to, bool shows_edge);

  /// Returns a mask whose bit i is set if nothing is removed over disc i.
  unsigned behind(const Discs& discs) const;

  /// Quantities of the test in the middle of the motion. For a point of the side at q from the
  /// axis, n·V times the radius is q·v′ − climb, v′ = v + m w, m = m0 + m1 l, climb = climb0 +
  /// climb1 l.
  struct Motion {
    Vec3 tip, axis, v, w;
    double low, high;  ///< heights of the slice's discs
    double m0, m1, climb0, climb1;
    double radius, lean;  ///< greatest radius; sine of the angle between axis and rays
    double level, level_min, level_max;  ///< horizontal length of the axis; least and greatest
    double aside;        ///< horizontal distance of the side from the axis, along the axis
    double half_travel;  ///< horizontal, of the tip
    double level_speed;  ///< greatest horizontal length of v′
    double bend;         ///< of q·v′ between two heights, per mm²
    double margin, margin_per_mm;  ///< greatest change of n·V until the ends, and over a disc
    bool whole;                    ///< any height of the slice may be over a position of the plane
    bool shows_edge;
  };

 private:
  Motion m_;
};

}  // namespace kerf
