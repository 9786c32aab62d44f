// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/tool/tool_pose.h"
#include "server/formats/scene.h"

namespace kerf {

/// Angles of the rotary axes of a machine, degrees.
struct RotaryAngles {
  double a = 0, b = 0, c = 0;
  friend bool operator==(const RotaryAngles&, const RotaryAngles&) = default;
};

/// Returns true for kXyzacTrt and kXyzbcTrt, whose table angles determine the tool axis.
bool has_rotary_table(MachineKinematics kinematics);

/// Returns the tool axis in the workpiece at given table angles, a unit vector:
///     xyzac-trt: (sin c sin a, cos c sin a, cos a)
///     xyzbc-trt: (-cos c sin b, sin c sin b, cos b)
///     otherwise: (0, 0, 1)
/// These signs are LinuxCNC's (RotaryDirection::kTable): a positive table angle turns the
/// workpiece, so that relative to it the tool turns in the opposite direction. With kTool all
/// angles have the other sign. Multiples of 90 degrees give exact zeros and ones.
Vec3 table_axis(const Machine& machine, const RotaryAngles& angles);

/// Returns the tool tip in the workpiece for programmed coordinates. With tool-center-point control
/// both are equal. Without it the tables turn about the work zero: the programmed point is fixed in
/// the machine and the workpiece turns under it.
Vec3 tip_from_programmed(const Machine& machine, bool tool_center_point, Vec3 programmed_mm,
                         const RotaryAngles& angles);
/// Inverse of tip_from_programmed.
Vec3 programmed_from_tip(const Machine& machine, bool tool_center_point, Vec3 tip_mm,
                         const RotaryAngles& angles);

/// Returns table angles for a tool axis (a unit vector). Of the two tilts and all multiples of a
/// turn, it chooses the pair with the least |change of tilt| + |change of c| from `previous`. For a
/// vertical axis c is unchanged. Returns zeros for machines without rotary tables.
RotaryAngles angles_from_axis(const Machine& machine, Vec3 axis, const RotaryAngles& previous);

/// The travel to which the feed of a straight motion applies.
struct FeedTravel {
  double mm = 0;   ///< travel of the tip
  double deg = 0;  ///< turn of the axis
  /// The travel of the tip or, if it is at rest, the turn: the feed is then in degrees per minute.
  double length() const { return mm > 0 ? mm : deg; }
};
FeedTravel feed_travel(const ToolPose& from, const ToolPose& to);

/// Returns the unit vector at `share` (0 to 1) of the great circle from `a` to `b`. They need not
/// be unit vectors but must not be opposite.
Vec3 turned_axis(Vec3 a, Vec3 b, double share);

}  // namespace kerf
