// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/lanes.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// Eight vectors at once.
struct Vec3Lanes {
  Lanes x, y, z;
};

KERF_INLINE Vec3Lanes operator+(Vec3Lanes a, Vec3Lanes b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
KERF_INLINE Vec3Lanes operator-(Vec3Lanes a, Vec3Lanes b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
KERF_INLINE Vec3Lanes operator*(Vec3Lanes a, Lanes s) { return {a.x * s, a.y * s, a.z * s}; }
KERF_INLINE Vec3Lanes operator*(Vec3 a, Lanes s) { return {a.x * s, a.y * s, a.z * s}; }
KERF_INLINE Vec3Lanes operator+(Vec3 a, Vec3Lanes b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
KERF_INLINE Lanes dot(Vec3Lanes a, Vec3Lanes b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
KERF_INLINE Vec3Lanes cross(Vec3 a, Vec3Lanes b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace kerf
