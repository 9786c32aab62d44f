// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace kerf {

/// A distance somewhere on a surface, and how much of the surface it stands for.
struct DistanceSample {
  double mm = 0;
  double weight = 1;
};

/// What is said of many distances. They may have a sign; the percentiles are of their sizes.
struct DistanceFigures {
  double min_mm = 0, max_mm = 0, mean_mm = 0, rms_mm = 0;
  double p50_mm = 0, p90_mm = 0, p99_mm = 0;  ///< so many of 100 parts of the weight are nearer
  std::size_t samples = 0;
};
DistanceFigures distance_figures(std::vector<DistanceSample> samples);

}  // namespace kerf
