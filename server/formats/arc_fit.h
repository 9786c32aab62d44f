// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "kernel/tool/tool_pose.h"
#include "server/formats/control/plane.h"

namespace kerf {

/// An arc or helix, of less than a turn, in one of the planes of a control.
struct FittedArc {
  ArcPlane plane = ArcPlane::kXy;
  PlanePoint center;              ///< in the plane; its normal coordinate is 0
  bool counterclockwise = false;  ///< seen against the plane's normal: G3
  bool helical = false;           ///< the tip moves along the normal, too
  bool keeps_center = false;      ///< the radii at the ends may differ: do not move the center
  friend bool operator==(const FittedArc& a, const FittedArc& b) {
    return a.plane == b.plane && a.center.first == b.center.first &&
           a.center.second == b.center.second && a.counterclockwise == b.counterclockwise &&
           a.helical == b.helical;
  }
};

/// Greatest sweep of one arc, degrees. Controls disagree about arcs whose ends are close together.
inline constexpr double kArcSweepMaxDeg = 300;

/// Returns the arc through both ends of a path of straight motions that is within `tolerance_mm` of
/// every point of the path, or nullopt. The path has at least four poses, all with the same axis.
std::optional<FittedArc> fit_arc(std::span<const ToolPose> path, double tolerance_mm);

/// Returns the arc with its center moved to equal distance from both ends, which differ in the
/// plane.
FittedArc with_equal_radii(const FittedArc& arc, Vec3 from, Vec3 to);

/// The length of an arc's path between two tips, mm.
double arc_length_mm(const FittedArc& arc, Vec3 from, Vec3 to);

}  // namespace kerf
