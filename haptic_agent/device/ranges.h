// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf::agent {

// Accepted ranges of numbers from files, peers and command lines. Each begins at zero unless stated
// otherwise.

/// Greatest coordinate, ±, mm. The kernel's kCoordinateMaxMm.
inline constexpr double kPlaceMaxMm = 1e6;
/// Greatest distance of the pivot from the tip, mm: the length of the longest tool. The device's
/// grip is at the pivot, so an error of the axis moves it by that length.
inline constexpr double kPivotMaxMm = 5000;

/// Greatest coordinate in a device's own space, ±, mm.
inline constexpr double kWorkspaceMaxMm = 1e5;

/// Capabilities of a device.
inline constexpr std::uint32_t kLatencyMaxUs = 20'000;
inline constexpr double kResolutionMaxMm = 1, kResolutionMaxRad = 0.1;
inline constexpr double kMovingMassMaxKg = 100, kMovingInertiaMaxKgM2 = 10;

/// Options of a user: limits of the output, duration, stiffness of the simulated hand (N/mm).
inline constexpr double kForceLimitMaxN = 50, kTorqueLimitMaxNmm = 2000;
inline constexpr double kDurationMinS = 1e-3, kDurationMaxS = 1e6;
inline constexpr double kHandStiffnessMin = 1e-2, kHandStiffnessMax = 20;

}  // namespace kerf::agent
