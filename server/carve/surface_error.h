// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <stop_token>

#include "kernel/dexel/solid_snapshot.h"
#include "server/verify/cut_surface.h"
#include "server/verify/distance_figures.h"
#include "server/verify/true_solid.h"

namespace kerf {

/// Measures the distance from the mesh of a snapshot to the true solid at corners and centroids of
/// triangles. Meshes the tiles that a tool has touched (all, or an even selection) and measures
/// about `samples` evenly selected points. Points nearest to the stock's own border are excluded,
/// because the result is the error of the cuts. Features missing from the mesh are not measured
/// (measure_missing()). Equal snapshots give equal results. Ends early, with the figures of fewer
/// points, if a stop is requested.
DistanceFigures measure_surface(const SolidSnapshot& snapshot, const TrueSolid& truth,
                                std::size_t samples, const std::stop_token& stop = {});

/// Measures the distance from points of the true surface to the mesh of a snapshot, exactly. Large
/// where a wall, a ridge or a groove is missing from the mesh. Meshes the tiles around the points.
/// Ends early, with the figures of fewer points, if a stop is requested.
DistanceFigures measure_missing(const SolidSnapshot& snapshot, const CutSurface& surface,
                                const std::stop_token& stop = {});

}  // namespace kerf
