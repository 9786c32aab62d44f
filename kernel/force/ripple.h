// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace kerf {

/// Ripple of the force at constant engagement, rms over mean, that steady_radial_mm refers to.
inline constexpr double kSteadyRipple = 0.05;

/// Returns the radial engagement, mm, from which on a wall of radius `diameter_mm` / 2 along the
/// rays is cut, with 1 or 3 `fields`, with a ripple of at most kSteadyRipple. With one field the
/// ripple is at most 0.27 sqrt(p D) / a, because the part of the front that a few rows of rays
/// enter together is sqrt(p D) long. With three, walls are weighted by their normal, and five
/// pitches suffice at a depth of 20 pitches. Measured by `force_bench 0.1 light`
/// (kernel/force/README.md, "Light cuts").
inline double steady_radial_mm(int fields, double pitch_mm, double diameter_mm) {
  return fields == 1 ? 6 * std::sqrt(pitch_mm * diameter_mm) : 5 * pitch_mm;
}

}  // namespace kerf
