// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "kernel/dexel/solid_snapshot.h"
#include "server/carve/distance_figures.h"
#include "server/carve/true_solid.h"

namespace kerf {

/// Distance of a mesh from the true solid, over the corners and centroids of triangles.
///
/// Meshes tiles that a tool has touched (all, or evenly chosen ones) and measures about `samples`
/// evenly chosen corners and centroids. Those to which the stock's own border is nearest do not
/// count: the question is how well cuts are made. Equal snapshots give equal results.
DistanceFigures measure_surface(const SolidSnapshot& snapshot, const TrueSolid& truth,
                                std::size_t samples);

}  // namespace kerf
