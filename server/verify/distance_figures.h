// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace kerf {

/// A distance at a point of a surface, and the area that it represents.
struct DistanceSample {
  double mm = 0;
  double weight = 1;
};

/// Statistics of distances, which may be signed. The percentiles are those of the absolute values.
struct DistanceFigures {
  double min_mm = 0, max_mm = 0, mean_mm = 0, rms_mm = 0;
  double p50_mm = 0, p90_mm = 0, p99_mm = 0;  ///< percentiles by weight
  std::size_t samples = 0;
};
DistanceFigures distance_figures(std::vector<DistanceSample> samples);

}  // namespace kerf
