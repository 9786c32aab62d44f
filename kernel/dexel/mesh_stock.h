// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "kernel/dexel/column_shares.h"
#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/stock_shape.h"
#include "kernel/dexel/stop_asked.h"
#include "kernel/dexel/tile_index.h"
#include "kernel/dexel/triangle_mesh.h"

namespace kerf {

struct DexelTile;

/// Returns the bounding box of a mesh's triangles. The mesh must have at least one vertex.
BoxStock mesh_bounds(const TriangleMesh& mesh);

/// Returns why a mesh does not bound a solid, as one sentence with counts and a position, or an
/// empty string if it does. A mesh bounds a solid if its coordinates are finite and each edge is
/// used equally often in both directions.
std::string mesh_stock_fault(const TriangleMesh& mesh);

/// Converts a closed mesh (mesh_stock_fault returns an empty string) to dexels on a grid. A point
/// is solid where the winding number along its ray is not zero: overlapping bodies are united,
/// cavities stay empty, and the mesh may be inside out. Rays through an edge or a vertex are
/// handled consistently, because every edge is compared with a ray by one expression that does not
/// depend on the triangle. So hits always come in pairs (kernel/dexel/README.md). Ends are rounded
/// to the nearest quantum.
///
/// Calls put(tile, columns) for every tile that is not solid throughout, with its elements and, if
/// `keep_normals`, the normals of the triangles that the rays hit. Unless `shares` is null, sets
/// the shares of columns next to walls in it (MeshShares). Ends after a row of tiles, with the
/// other rows missing, if a stop is asked.
void dexelize(const TriangleMesh& mesh, const DexelGrid& grid, bool keep_normals,
              const std::function<void(TileIndex, std::shared_ptr<DexelTile>)>& put,
              ColumnShares* shares = nullptr, const StopAsked& stop_asked = {});

}  // namespace kerf
