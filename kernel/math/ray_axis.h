// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/math/vec3.h"

namespace kerf {

/// Axis along which the rays of a field run. Each field works in its own right-handed frame, in
/// which its rays run along +Z. The frame is a cyclic permutation of the coordinates, so nothing is
/// rounded or mirrored. Z: local (x, y, z). X: local (y, z, x). Y: local (z, x, y).
enum class RayAxis : std::uint8_t { kX, kY, kZ };

/// Converts a position or direction from the world to the frame of the field along `axis`.
constexpr Vec3 to_frame(RayAxis axis, Vec3 world) {
  switch (axis) {
    case RayAxis::kX:
      return {world.y, world.z, world.x};
    case RayAxis::kY:
      return {world.z, world.x, world.y};
    case RayAxis::kZ:
      break;
  }
  return world;
}

/// Converts back: from_frame(axis, to_frame(axis, v)) == v, bit for bit.
constexpr Vec3 from_frame(RayAxis axis, Vec3 local) {
  switch (axis) {
    case RayAxis::kX:
      return {local.z, local.x, local.y};
    case RayAxis::kY:
      return {local.y, local.z, local.x};
    case RayAxis::kZ:
      break;
  }
  return local;
}

}  // namespace kerf
