// SPDX-License-Identifier: Apache-2.0
// Fig. 18: the furniture surface is the one that the program states.

#include <algorithm>
#include <cmath>
#include <span>

#include "tests/paper/check.h"
#include "tests/paper/examples.h"

namespace kerf::paper {
namespace {

/// Columns this near to the stock's sides are met by the tool from one side only.
constexpr double kRimMm = 2;

double top_mm(const DexelSnapshot& block, std::int32_t i, std::int32_t j) {
  return block.grid().z_mm(block.view(i, j).topmost.top);
}

/// The least and greatest height of the carved front above the front, along its normal, mm.
struct Scallops {
  double least = 0, greatest = 0;
};

Scallops scallops_of(const DexelSnapshot& block, const BoxStock& stock) {
  const DexelGrid& grid = block.grid();
  Scallops found;
  for (std::int32_t j = 0; j < grid.columns_y; ++j) {
    for (std::int32_t i = 0; i < grid.columns_x; ++i) {
      const double x = grid.x_mm(i), y = grid.y_mm(j);
      const double rim = std::min(
          {x - stock.min_mm.x, stock.max_mm.x - x, y - stock.min_mm.y, stock.max_mm.y - y});
      if (rim < kRimMm) continue;
      const Vec3 surface = front_point(x, y), normal = front_normal(x, y);
      const double off = (top_mm(block, i, j) - surface.z) * normal.z;
      found.least = std::min(found.least, off);
      found.greatest = std::max(found.greatest, off);
    }
  }
  return found;
}

/// Returns the greatest distance, mm, of a groove's bottom from the poses of the tip that cut it,
/// at the columns next to the tip.
double groove_error_mm(const DexelSnapshot& block, std::span<const ToolPose> spirals) {
  const DexelGrid& grid = block.grid();
  const BoxStock stock = std::get<BoxStock>(furniture().settings.stock);
  double worst = 0;
  for (const ToolPose& pose : spirals) {
    const Vec3 tip = pose.tip_mm;
    const double below = dot(front_point(tip.x, tip.y) - tip, pose.axis);
    if (below < 1) continue;  // above the front, or where the groove begins
    const auto i = std::int32_t((tip.x - stock.min_mm.x) / grid.pitch_mm);
    const auto j = std::int32_t((tip.y - stock.min_mm.y) / grid.pitch_mm);
    const double dx = grid.x_mm(i) - tip.x, dy = grid.y_mm(j) - tip.y;
    // On the plane across the axis.
    const double z = tip.z - (pose.axis.x * dx + pose.axis.y * dy) / pose.axis.z;
    worst = std::max(worst, std::abs(top_mm(block, i, j) - z) * pose.axis.z);
  }
  return worst;
}

Finding the_furniture_is_the_stated_surface() {
  std::size_t spirals = 0;
  Example one = furniture(&spirals);
  const auto first = one.path.size() - spirals;
  const BoxStock stock = std::get<BoxStock>(one.settings.stock);
  Carved whole = carve(one);
  const double groove = groove_error_mm(whole.block.snapshot(), std::span(one.path).subspan(first));
  double steepest = 1;
  for (const ToolPose& pose : one.path) steepest = std::min(steepest, pose.axis.z);
  const std::size_t motions = whole.steps.size();
  one.path.resize(first);
  const Scallops front = scallops_of(carve(one).block.snapshot(), stock);
  const double lean_deg = std::acos(steepest) * 57.29577951308232;
  return {front.least > -0.01 && front.greatest < 0.05 && groove < 0.03 && lean_deg > 10,
          text("%zu motions, axis leaning up to %.0f°: the front is within %.3f mm below and %.3f "
               "mm above the surface (scallops of a ball of 3 mm), the grooves within %.3f mm of "
               "their depth",
               motions, lean_deg, -front.least, front.greatest, groove)};
}

}  // namespace

std::vector<Check> furniture_checks() {
  return {{"TheFurnitureIsTheStatedSurface", the_furniture_is_the_stated_surface}};
}

}  // namespace kerf::paper
