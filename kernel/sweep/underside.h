// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/piece/tool_piece.h"
#include "kernel/sweep/column_block.h"
#include "kernel/sweep/turning_frame.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// Lower bounds of the heights that a moving slice of an upright or leaning tool can reach: planes
/// that touch it from below, at its lower disc and at its side below a position
/// (kernel/sweep/bounds.md, "Below a tool").
class Underside {
 public:
  /// The slice, a frustum or an arc, moves from one pose to the other. Their axes are less than
  /// kTurnPerFrameMaxRad apart.
  Underside(const ToolPiece& slice, const ToolPose& from, const ToolPose& to);

  /// Raises `z_mm`, lower bounds of the heights that the slice reaches within each disc.
  void raise(const Discs& discs, Lanes& z_mm) const;

  /// The slice at a share of the motion; positions relative to the middle tip.
  struct Station {
    Vec3 tip, u;
    Vec3 turned;  ///< a direction e of the middle has turned by (e·w) times this
    /// Height of the plane of the lower disc: at_origin + by_x x + by_y y, `steepness` its slope.
    double at_origin, by_x, by_y, steepness;
  };
  static constexpr int kStationsMax = 5;
  struct Motion {
    Vec3 tip, u, w;
    bool leans_little;  ///< if false, the planes may not be below the slice, and there is no bound
    bool is_arc;
    double middle;            ///< height of the arc's center, or of the frustum's lower disc
    double center_r, radius;  ///< of the arc
    double cosine, sine;      ///< of the frustum's side: the normal is e cosine + u sine
    double support;           ///< of the frustum: greatest component of a point along that normal
    double margin;            ///< greatest distance of the slice beyond the planes of its stations
    int stations;
    Station station[kStationsMax];
  };

 private:
  Motion m_;
};

}  // namespace kerf
