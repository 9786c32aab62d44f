// SPDX-License-Identifier: Apache-2.0
#include "server/formats/machine_kinematics.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "kernel/math/rotation.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

// Sine and cosine of degrees. Multiples of 90 give exact zeros and ones, so that a vertical tool is
// exactly vertical.
double sin_deg(double deg) {
  const double turn = std::remainder(deg, 360.0);
  if (turn == 0 || std::abs(turn) == 180) return 0;
  if (std::abs(turn) == 90) return turn > 0 ? 1 : -1;
  return std::sin(turn * kRadPerDeg);
}
double cos_deg(double deg) {
  const double turn = std::remainder(deg, 360.0);
  if (std::abs(turn) == 90) return 0;
  if (std::abs(turn) == 180) return -1;
  return std::cos(turn * kRadPerDeg);
}

// Rows of the rotation matrix from workpiece to machine. Its transpose is the inverse. The third
// row is the tool axis in the workpiece.
struct TableRotation {
  Vec3 x, y, z;
};

// Converts between programmed angles and those of LinuxCNC's tables.
RotaryAngles signed_angles(const Machine& machine, const RotaryAngles& angles) {
  if (machine.rotary_direction == RotaryDirection::kTable) return angles;
  return {0 - angles.a, 0 - angles.b, 0 - angles.c};
}

TableRotation table_rotation(const Machine& machine, const RotaryAngles& written) {
  const RotaryAngles angles = signed_angles(machine, written);
  const double sc = sin_deg(angles.c);
  const double cc = cos_deg(angles.c);
  switch (machine.kinematics) {
    case MachineKinematics::kXyzacTrt: {
      const double sa = sin_deg(angles.a);
      const double ca = cos_deg(angles.a);
      return {{cc, -sc, 0}, {sc * ca, cc * ca, -sa}, {sc * sa, cc * sa, ca}};
    }
    case MachineKinematics::kXyzbcTrt: {
      const double sb = sin_deg(angles.b);
      const double cb = cos_deg(angles.b);
      return {{cc * cb, -sc * cb, sb}, {sc, cc, 0}, {-cc * sb, sc * sb, cb}};
    }
    case MachineKinematics::kXyz:
    case MachineKinematics::kToolVector:
      break;
  }
  return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
}

double nearest_turn(double angle_deg, double previous_deg) {
  return previous_deg + std::remainder(angle_deg - previous_deg, 360.0);
}

}  // namespace

bool has_rotary_table(MachineKinematics kinematics) {
  return kinematics == MachineKinematics::kXyzacTrt || kinematics == MachineKinematics::kXyzbcTrt;
}

Vec3 table_axis(const Machine& machine, const RotaryAngles& angles) {
  return table_rotation(machine, angles).z;
}

Vec3 tip_from_programmed(const Machine& machine, bool tool_center_point, Vec3 programmed_mm,
                         const RotaryAngles& angles) {
  if (tool_center_point || !has_rotary_table(machine.kinematics)) return programmed_mm;
  const TableRotation r = table_rotation(machine, angles);
  return r.x * programmed_mm.x + r.y * programmed_mm.y + r.z * programmed_mm.z;
}

Vec3 programmed_from_tip(const Machine& machine, bool tool_center_point, Vec3 tip_mm,
                         const RotaryAngles& angles) {
  if (tool_center_point || !has_rotary_table(machine.kinematics)) return tip_mm;
  const TableRotation r = table_rotation(machine, angles);
  return {dot(r.x, tip_mm), dot(r.y, tip_mm), dot(r.z, tip_mm)};
}

RotaryAngles angles_from_axis(const Machine& machine, Vec3 axis, const RotaryAngles& before) {
  if (!has_rotary_table(machine.kinematics)) return {};
  const RotaryAngles previous = signed_angles(machine, before);
  const bool ac = machine.kinematics == MachineKinematics::kXyzacTrt;
  const double tilt = std::atan2(std::hypot(axis.x, axis.y), axis.z) / kRadPerDeg;
  const double turn = (ac ? std::atan2(axis.x, axis.y) : std::atan2(axis.y, -axis.x)) / kRadPerDeg;
  const double previous_tilt = ac ? previous.a : previous.b;
  const bool upright = axis.x == 0 && axis.y == 0;
  RotaryAngles best;
  double best_change = std::numeric_limits<double>::infinity();
  for (const double sign : {1.0, -1.0}) {
    const double t = nearest_turn(sign * tilt, previous_tilt);
    const double c = upright ? previous.c : nearest_turn(sign > 0 ? turn : turn + 180, previous.c);
    const double change = std::abs(t - previous_tilt) + std::abs(c - previous.c);
    if (change < best_change) {
      best_change = change;
      best = ac ? RotaryAngles{t, 0, c} : RotaryAngles{0, t, c};
    }
  }
  return signed_angles(machine, best);
}

FeedTravel feed_travel(const ToolPose& from, const ToolPose& to) {
  return {length(to.tip_mm - from.tip_mm),
          angle_between(normalized(from.axis), normalized(to.axis)) * 180 / std::numbers::pi};
}

Vec3 turned_axis(Vec3 a, Vec3 b, double share) {
  const Vec3 from = normalized(a);
  const Vec3 to = normalized(b);
  return great_circle(from, to, angle_between(from, to), share);
}

}  // namespace kerf
