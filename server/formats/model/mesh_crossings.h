// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "server/formats/model/indexed_mesh.h"

namespace kerf {

/// Returns the triangles of a mesh that meet another one outside common corners and edges, and
/// those without area, by exact predicates on the positions relative to the origin. Sorted, each
/// once. Uses a tree of boxes: O(n log n) unless many boxes overlap. Returns the triangles found so
/// far if a stop is requested.
std::vector<std::uint32_t> crossing_triangles(const IndexedMesh& mesh,
                                              const std::stop_token& stop = {});

}  // namespace kerf
