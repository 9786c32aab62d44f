// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/stock_shape.h"
#include "kernel/dexel/tile_index.h"
#include "kernel/dexel/triangle_mesh.h"

namespace kerf {

struct DexelTile;

/// The box around a mesh; the mesh must have a vertex.
BoxStock mesh_bounds(const TriangleMesh& mesh);

/// Why a mesh bounds no solid, as one sentence with counts and a place; empty if it does. It does
/// if its coordinates are finite and each edge has as many triangles on one side as on the other.
std::string mesh_stock_fault(const TriangleMesh& mesh);

/// Dexelises a mesh that has no fault on a grid. Solid is where the winding number along the ray is
/// not zero: bodies that overlap are united, a cavity is a cavity, and a mesh that is inside out is
/// as good as one that is not. A ray that meets an edge or a vertex meets the triangles around it
/// consistently: every edge is compared with a ray by one and the same expression, whichever
/// triangle asks, so hits always come in pairs. Ends are rounded to the nearest quantum.
///
/// Calls put(tile, columns) for every tile that is not solid from the bottom to the top everywhere,
/// with its elements and, if asked for, the normals of the triangles that were met.
void dexelize(const TriangleMesh& mesh, const DexelGrid& grid, bool keep_normals,
              const std::function<void(TileIndex, std::shared_ptr<DexelTile>)>& put);

}  // namespace kerf
