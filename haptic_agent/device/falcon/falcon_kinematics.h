// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "haptic_agent/device/step_tracker.h"
#include "kernel/math/vec3.h"

namespace kerf::agent::falcon {

/// Angles of the three driven legs, rad.
using LegAngles = std::array<double, 3>;

/// Center and half size of the workspace, in the Falcon's coordinates, mm: x to the right, y up, z
/// towards the user, with the origin in the base plate. The grip reaches about 55 mm to each side,
/// and z = 75 to 175 mm.
inline constexpr Vec3 kMiddleMm{0, 0, 125};
inline constexpr double kReachMm = 60;

/// Converts an encoder count to a leg angle: 4 x 320 counts per turn of a 14.25 mm shaft, which
/// drives a 110 mm arm by a cable; 35 degrees at count zero (libnifalcon's measurements).
double angle_of(std::int16_t count) noexcept;
std::int16_t count_of(double angle_rad) noexcept;

/// Estimates the legs' angles between the counts of their encoders. A count moves all three
/// coordinates of the grip, by about 0.04 mm in all, so the coordinates have no steps of their own.
class LegTracker {
 public:
  LegTracker() noexcept;
  /// Adds the counts measured `dt_s` after the last ones. Returns the estimated angles.
  LegAngles take(const std::array<std::int16_t, 3>& counts, double dt_s) noexcept;
  void reset() noexcept;

 private:
  std::array<StepTracker, 3> legs_;
};

/// Inverse kinematics in closed form. Returns nullopt if the position is out of reach.
std::optional<LegAngles> leg_angles(Vec3 position_mm) noexcept;

/// Forward kinematics by Newton iteration from `guess_mm`. Returns nullopt if 15 steps do not
/// converge to 1 um, because no position has such angles.
std::optional<Vec3> position_of(const LegAngles& angles, Vec3 guess_mm) noexcept;

/// Leg torques, N·mm, that exert `force_n` at the grip: tau = J^T f with J = dp/dtheta. Returns
/// nullopt at singular configurations.
std::optional<std::array<double, 3>> leg_torques(const LegAngles& angles, Vec3 position_mm,
                                                 Vec3 force_n) noexcept;

/// Converts directions from the Falcon's axes to Kerf's (x right, y away from the user, z up), and
/// back.
constexpr Vec3 to_kerf(Vec3 v) noexcept { return {v.x, -v.z, v.y}; }
constexpr Vec3 from_kerf(Vec3 v) noexcept { return {v.x, v.z, -v.y}; }

}  // namespace kerf::agent::falcon
