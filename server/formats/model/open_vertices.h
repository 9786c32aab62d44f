// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "kernel/dexel/triangle_mesh.h"

namespace kerf {

/// Whether every edge is used as often in one direction as in the other. Of 2^64 meshes with an
/// open edge about one is taken for closed. Needs no memory, and a tenth of the time of
/// for_each_edge.
bool seems_closed(const TriangleMesh& mesh);

/// Joins each vertex on an edge of one triangle only to the first such vertex that is nearer than
/// `share` of the mesh's diagonal. Triangles may have equal corners then. Returns how many vertices
/// were joined; none is removed. Equal meshes give equal bytes.
std::size_t join_open_vertices(TriangleMesh& mesh, double share);

}  // namespace kerf
