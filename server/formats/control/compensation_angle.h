// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <string>

#include "server/formats/control/fault.h"

namespace kerf {

// Shared by the parts of CutterCompensation.

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2 * kPi;
inline constexpr double kHalfPi = kPi / 2;

/// Path directions that differ by less than this do not make a corner (LinuxCNC's value), rad.
inline constexpr double kCornerMinRad = 0.05;

/// Whether a value has an arc sine and cosine; false for NaN.
inline bool within_one(double value) { return value >= -1 && value <= 1; }

/// Throws ProgramFault for a point of the path that the tool cannot reach.
[[noreturn]] inline void reject_gouging(const char* place) {
  throw ProgramFault{"", std::string(place) +
                             " cannot be reached without gouging; use a smaller tool or a larger "
                             "radius"};
}

}  // namespace kerf
