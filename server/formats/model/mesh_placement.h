// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/dexel/triangle_mesh.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// Position of a file's mesh in a scene: its coordinates times unit and scale, turned about the
/// origin, then moved.
struct MeshPlacement {
  double unit_mm = 1;   ///< length of the file's unit, > 0
  Vec3 scale{1, 1, 1};  ///< along the file's x, y and z, each > 0
  Vec3 rotate_deg;      ///< about the scene's x, then y, then z; each within ±360
  Vec3 translate_mm;
  friend bool operator==(const MeshPlacement&, const MeshPlacement&) = default;
};

/// Moves all vertices. Turns by multiples of 90 degrees are exact. Gives the same bytes on all
/// machines.
void place_mesh(TriangleMesh& mesh, const MeshPlacement& placement);

}  // namespace kerf
