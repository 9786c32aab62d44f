// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stop_token>
#include <vector>

#include "server/formats/model/indexed_mesh.h"
#include "server/formats/model/mesh_nearest.h"

namespace kerf {

/// Where collapsing ends.
struct CollapseLimits {
  std::size_t triangles = 0;                                  ///< collapsing stops at this number
  double error_mm = std::numeric_limits<double>::infinity();  ///< greatest distance of any vertex
                                                              ///< of the mesh from the result
};

/// Collapses edges of a closed 2-manifold in about the order of their error and returns the
/// remaining triangles. A vertex moves to the other end of an edge, so the vertices of the result
/// are some of the mesh; those in `kept` do not move. The order is that of quadric errors
/// (quadric.h). No collapse
///   - makes the surface open or more than two triangles share an edge (the link condition),
///   - turns a triangle by more than about 75 degrees, or makes a needle without area,
///   - moves a vertex of the mesh, removed ones included, beyond `error_mm`: each removed vertex
///     belongs to a triangle that is that near (after Klein, Liebich, Strasser, Mesh reduction with
///     error control, 1996),
///   - folds a triangle onto its neighbor.
/// Middles of triangles and edges of the result are about as near to the mesh, which is checked by
/// estimates. Sheets of thin walls may cross.
/// Ends early, with the collapses so far, if a stop is requested.
/// Precondition: kept.size() is the number of vertices.
std::vector<std::array<std::uint32_t, 3>> collapse_edges(const IndexedMesh& mesh,
                                                         const MeshNearest& nearest,
                                                         const std::vector<bool>& kept,
                                                         const CollapseLimits& limits,
                                                         const std::stop_token& stop = {});

}  // namespace kerf
