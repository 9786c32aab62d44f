// SPDX-License-Identifier: Apache-2.0
#include "server/verify/distance_figures.h"

#include <algorithm>
#include <cmath>

namespace kerf {

DistanceFigures distance_figures(std::vector<DistanceSample> samples) {
  if (samples.empty()) return {};
  DistanceFigures figures{
      .min_mm = samples.front().mm, .max_mm = samples.front().mm, .samples = samples.size()};
  double weight = 0, sum = 0, squares = 0;
  for (DistanceSample& sample : samples) {
    figures.min_mm = std::min(figures.min_mm, sample.mm);
    figures.max_mm = std::max(figures.max_mm, sample.mm);
    weight += sample.weight;
    sum += sample.weight * sample.mm;
    squares += sample.weight * sample.mm * sample.mm;
    sample.mm = std::abs(sample.mm);
  }
  figures.mean_mm = sum / weight;
  figures.rms_mm = std::sqrt(squares / weight);
  std::ranges::sort(samples, {}, &DistanceSample::mm);
  double below = 0;
  for (const DistanceSample& sample : samples) {
    // The first sample whose cumulative weight exceeds that fraction.
    if (below <= 0.5 * weight) figures.p50_mm = sample.mm;
    if (below <= 0.9 * weight) figures.p90_mm = sample.mm;
    if (below <= 0.99 * weight) figures.p99_mm = sample.mm;
    below += sample.weight;
  }
  return figures;
}

}  // namespace kerf
