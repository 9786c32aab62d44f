// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace kerf {

/// A position or normal of a mesh.
using Float3 = std::array<float, 3>;

inline float dot(const Float3& a, const Float3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline Float3 minus(const Float3& a, const Float3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

}  // namespace kerf
