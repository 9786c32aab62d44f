// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "kernel/math/vec3.h"

namespace kerf::agent {

/// Rounds each coordinate to the nearest multiple of `quantum`, like the encoder of a simulated
/// device. 0 disables rounding.
inline Vec3 rounded(Vec3 v, double quantum) noexcept {
  if (!(quantum > 0)) return v;
  return {quantum * std::round(v.x / quantum), quantum * std::round(v.y / quantum),
          quantum * std::round(v.z / quantum)};
}

}  // namespace kerf::agent
