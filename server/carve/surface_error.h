// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "kernel/dexel/solid_snapshot.h"
#include "server/carve/distance_figures.h"
#include "server/carve/true_solid.h"

namespace kerf {

/// Measures the distance between the mesh of a snapshot and the true solid at corners and centroids
/// of triangles. Meshes the tiles that a tool has touched (all, or an even selection) and measures
/// about `samples` evenly selected points. Points nearest to the stock's own border are excluded,
/// because the result is the error of the cuts. Equal snapshots give equal results.
DistanceFigures measure_surface(const SolidSnapshot& snapshot, const TrueSolid& truth,
                                std::size_t samples);

}  // namespace kerf
