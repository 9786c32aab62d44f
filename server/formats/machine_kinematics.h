// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/tool/tool_pose.h"
#include "server/formats/scene.h"

namespace kerf {

/// Rotary axes of a machine, degrees.
struct RotaryAngles {
  double a = 0, b = 0, c = 0;
  friend bool operator==(const RotaryAngles&, const RotaryAngles&) = default;
};

/// True if the machine has rotary tables whose angles give the tool axis.
bool has_rotary_table(MachineKinematics kinematics);

/// The tool axis in the workpiece when the tables stand at `angles` (LinuxCNC's signs: a positive
/// table angle turns the workpiece, so the tool appears to turn the other way). xyzac-trt: (sin c
/// sin a, cos c sin a, cos a); xyzbc-trt:
/// (-cos c sin b, sin c sin b, cos b). Without rotary tables: +Z.
Vec3 table_axis(MachineKinematics kinematics, const RotaryAngles& angles);

/// The tool tip in the workpiece for programmed coordinates. With tool-centre-point control they
/// are the same; without it, the tables turn about the work zero: the programmed point is fixed in
/// space and the workpiece turns under it.
Vec3 tip_from_programmed(MachineKinematics kinematics, bool tool_center_point, Vec3 programmed_mm,
                         const RotaryAngles& angles);
/// The inverse of tip_from_programmed.
Vec3 programmed_from_tip(MachineKinematics kinematics, bool tool_center_point, Vec3 tip_mm,
                         const RotaryAngles& angles);

/// Angles that give `axis` (unit), as near to `previous` as the machine allows: of the two tilts
/// and all turns the one with the least |change of tilt| + |change of c|. Where the axis is
/// vertical, c stays.
RotaryAngles angles_from_axis(MachineKinematics kinematics, Vec3 axis,
                              const RotaryAngles& previous);

/// The unit vector at `share` (0 to 1) of the great circle from `a` to `b` (design section 3),
/// which need not be unit but must not be opposite.
Vec3 turned_axis(Vec3 a, Vec3 b, double share);

}  // namespace kerf
