// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "kernel/surface/tile_mesh.h"

namespace kerf::test {

/// Defects of a surface that closedness does not exclude, counted with exact predicates.
struct SelfIntersections {
  std::size_t triangles = 0;
  std::size_t pairs = 0;      ///< of triangles that meet elsewhere than in common corners and edges
  std::size_t crossed = 0;    ///< triangles in such pairs
  std::size_t zero_area = 0;  ///< triangles with collinear corners; not part of pairs
};

/// Counts the defects of the union of meshes. `cell_mm` is a typical size of the triangles.
SelfIntersections count_self_intersections(const std::vector<TileMesh>& meshes, double cell_mm);

}  // namespace kerf::test
