// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "kernel/math/vec3.h"

namespace kerf::agent::falcon {

/// Angles of the three driven legs, rad.
using LegAngles = std::array<double, 3>;

/// Positions in the Falcon's own coordinates, mm: x to the right, y up, z towards the user, zero in
/// the base plate. The grip moves within about 55 mm to each side and 75 to 175 mm out.
inline constexpr Vec3 kMiddleMm{0, 0, 125};
inline constexpr double kReachMm = 60;

/// The angle that a leg has at an encoder count: 4 x 320 counts a turn of a 14.25 mm shaft, which
/// drives a 110 mm arm by a cable; 35 degrees at zero (libnifalcon's measurements).
double angle_of(std::int16_t count) noexcept;
std::int16_t count_of(double angle_rad) noexcept;

/// Leg angles of a position; nothing out of reach. Closed form.
std::optional<LegAngles> leg_angles(Vec3 position_mm) noexcept;

/// The position of leg angles, by Newton from `guess_mm`; nothing if 15 steps do not reach 1 um:
/// such angles belong to no position.
std::optional<Vec3> position_of(const LegAngles& angles, Vec3 guess_mm) noexcept;

/// The legs' torques, N·mm, that push the grip with `force_n`: tau = J^T f with J = dp/dtheta.
/// Nothing where the legs are singular.
std::optional<std::array<double, 3>> leg_torques(const LegAngles& angles, Vec3 position_mm,
                                                 Vec3 force_n) noexcept;

/// Kerf's directions (x right, y away, z up) of the Falcon's, and back.
constexpr Vec3 to_kerf(Vec3 v) noexcept { return {v.x, -v.z, v.y}; }
constexpr Vec3 from_kerf(Vec3 v) noexcept { return {v.x, v.z, -v.y}; }

}  // namespace kerf::agent::falcon
