// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>
#include <vector>

#include "server/formats/model/mesh_distance.h"
#include "server/formats/model/mesh_source.h"
#include "server/verify/distance_figures.h"

namespace kerf {

/// A point of a surface with its distance from a reference (measure_deviation()).
struct DeviationPlace {
  double mm = 0;
  Vec3 at_mm;
  Vec3 normal;  ///< of the surface: unit, outward
};

/// Summary of the deviation of a surface.
struct DeviationSurvey {
  DistanceFigures figures;  ///< weighted by area; the extremes are those of vertices too
  double area_mm2 = 0;      ///< of the surface
  /// Signed deviations in equal steps of the area: the first is the least one, the last the
  /// greatest, and a share n / (size - 1) of the surface is not above number n. Empty for a surface
  /// without triangles.
  std::vector<double> quantiles_mm;
  /// Points at which the absolute value is greatest within their surroundings (1/40 of the diagonal
  /// of the surface's bounds and more) on their side of the reference, the worst first.
  std::vector<DeviationPlace> worst;
};

/// Number of steps between the quantiles, and of listed points.
inline constexpr std::size_t kQuantileSteps = 1000;
inline constexpr std::size_t kWorstPlacesMax = 10;

/// Surveys a surface at points at most about `spacing_mm` apart and at its vertices. Ends early,
/// with the survey of part of it, if a stop is requested.
DeviationSurvey survey_deviation(MeshSource& surface, const MeshDistance& reference,
                                 double spacing_mm,
                                 const std::function<void(double)>& progress = {},
                                 const std::stop_token& stop = {});

}  // namespace kerf
