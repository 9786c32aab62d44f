// SPDX-License-Identifier: Apache-2.0
#include "server/verify/deviation_survey.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include "server/verify/deviation.h"

namespace kerf {
namespace {

/// Cells along the diagonal of the surface's bounds. A listed point is the worst of its cell and of
/// the cells around it.
constexpr double kCellsOfDiagonal = 40;

using PlaceCell = std::array<std::int32_t, 3>;

/// The worst point of each cell of space, for each side of the reference.
class WorstOfCells {
 public:
  WorstOfCells(Vec3 origin_mm, double cell_mm) : origin_mm_(origin_mm), cell_mm_(cell_mm) {}

  void add(const DeviationPlace& place) {
    const Vec3 p = (place.at_mm - origin_mm_) * (1 / cell_mm_);
    const auto index = [](double v) { return static_cast<std::int32_t>(std::floor(v)); };
    const auto [at, is_new] =
        side(place.mm).try_emplace({index(p.x), index(p.y), index(p.z)}, place);
    if (!is_new && std::abs(place.mm) > std::abs(at->second.mm)) at->second = place;
  }

  std::vector<DeviationPlace> worst() const {
    std::vector<DeviationPlace> places;
    for (const auto& cells : sides_) {
      for (const auto& [cell, place] : cells)
        if (place.mm != 0 && is_worst(cells, cell)) places.push_back(place);
    }
    std::ranges::stable_sort(places, std::greater(),
                             [](const DeviationPlace& place) { return std::abs(place.mm); });
    if (places.size() > kWorstPlacesMax) places.resize(kWorstPlacesMax);
    return places;
  }

 private:
  using PlaceCells = std::map<PlaceCell, DeviationPlace>;

  PlaceCells& side(double mm) { return sides_.at(mm < 0 ? 0 : 1); }

  /// The first of equal cells counts.
  static bool is_worst(const PlaceCells& cells, const PlaceCell& cell) {
    const double mm = std::abs(cells.at(cell).mm);
    for (std::int32_t n = 0; n < 27; ++n) {
      const PlaceCell other{cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1};
      const auto found = cells.find(other);
      if (found == cells.end() || other == cell) continue;
      const double beside = std::abs(found->second.mm);
      if (beside > mm || (beside == mm && other < cell)) return false;
    }
    return true;
  }

  Vec3 origin_mm_;
  double cell_mm_;
  std::array<PlaceCells, 2> sides_;
};

class Surveyor final : public DeviationVisitor {
 public:
  Surveyor(Vec3 origin_mm, double cell_mm) : cells_(origin_mm, cell_mm) {}
  void vertex(Vec3 at_mm, Vec3 normal, double mm) override { place({mm, at_mm, normal}); }
  void sample(Vec3 at_mm, Vec3 normal, DistanceSample distance) override {
    place({distance.mm, at_mm, normal});
    samples_.push_back(distance);
  }
  DeviationSurvey survey() &&;

 private:
  void place(const DeviationPlace& place) {
    cells_.add(place);
    least_mm_ = std::min(least_mm_, place.mm);
    greatest_mm_ = std::max(greatest_mm_, place.mm);
  }

  WorstOfCells cells_;
  double least_mm_ = std::numeric_limits<double>::infinity(), greatest_mm_ = -least_mm_;
  std::vector<DistanceSample> samples_;
};

std::vector<double> quantiles_of(std::vector<DistanceSample> samples, double area) {
  if (samples.empty()) return {};
  std::ranges::sort(samples, {}, &DistanceSample::mm);
  std::vector<double> quantiles;
  double below = 0;
  for (const DistanceSample& sample : samples) {
    below += sample.weight;
    while (quantiles.size() <= kQuantileSteps &&
           static_cast<double>(quantiles.size()) * area <= below * kQuantileSteps) {
      quantiles.push_back(sample.mm);
    }
  }
  // The sum of the areas in another order may differ in the last bit.
  quantiles.resize(kQuantileSteps + 1, samples.back().mm);
  quantiles.back() = samples.back().mm;
  return quantiles;
}

DeviationSurvey Surveyor::survey() && {
  DeviationSurvey survey;
  for (const DistanceSample& sample : samples_) survey.area_mm2 += sample.weight;
  survey.worst = cells_.worst();
  survey.quantiles_mm = quantiles_of(samples_, survey.area_mm2);
  survey.figures = distance_figures(std::move(samples_));
  if (survey.quantiles_mm.empty()) return survey;
  // Vertices have no area, but the extremes are often there.
  survey.quantiles_mm.front() = survey.figures.min_mm = least_mm_;
  survey.quantiles_mm.back() = survey.figures.max_mm = greatest_mm_;
  return survey;
}

}  // namespace

DeviationSurvey survey_deviation(MeshSource& surface, const MeshDistance& reference,
                                 double spacing_mm, const std::function<void(double)>& progress,
                                 const std::stop_token& stop) {
  Surveyor surveyor(surface.origin_mm(), length(surface.size_mm()) / kCellsOfDiagonal);
  visit_deviation(surface, reference, spacing_mm, surveyor, progress, stop);
  return std::move(surveyor).survey();
}

}  // namespace kerf
