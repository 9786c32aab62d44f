// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/dexel/dexel_grid.h"
#include "kernel/surface/tile_mesh.h"

namespace kerf {

/// Greatest difference of a simplified surface from the exact one.
struct MergeBound {
  double error_mm = 0;
  double turn = 0;  ///< greatest length of the difference of two unit normals
};

/// Merges the quadrangles of a tile's mesh into larger right triangles between some of their
/// corners, where the surface is smooth enough (a restricted quadtree: Lindstrom et al. 1996,
/// "Real-time, continuous level of detail rendering of height fields"). Returns the indices of all
/// triangles, three each. A dropped corner was at most `error_mm` from the triangles that replace
/// it, along its normal, which was within `turn` of theirs, and the surface around it was all
/// original or all cut. Triangles of other shapes, at creases, walls and flat rectangles, stay, and
/// so does every edge of the tile's border, so a closed surface stays closed.
std::vector<std::uint32_t> merged_quads(const TileMesh& mesh, const DexelGrid& grid,
                                        const MergeBound& bound);

}  // namespace kerf
