// SPDX-License-Identifier: Apache-2.0
#include "server/carve/misfits.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <unordered_map>
#include <utility>

#include "kernel/math/rotation.h"
#include "server/carve/attached_material.h"
#include "server/formats/machine_kinematics.h"
#include "server/verify/column_misfits.h"
#include "server/verify/tool_profile.h"
#include "server/verify/true_solid.h"

namespace kerf {
namespace {

// A motion is sampled in steps of the distance to the tool, but at least this, mm.
constexpr double kStepMinMm = 1e-3;

std::uint64_t key(std::int32_t i, std::int32_t j) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) << 32) |
         static_cast<std::uint32_t>(j);
}

// Adjacent columns, including diagonal ones, form one misfit.
std::vector<Misfit> joined(const std::vector<ColumnMisfit>& columns, const DexelSnapshot& block) {
  const DexelGrid& grid = block.grid();
  std::unordered_map<std::uint64_t, std::size_t> open;
  for (std::size_t n = 0; n < columns.size(); ++n) open.emplace(key(columns[n].i, columns[n].j), n);
  const double square = grid.pitch_mm * grid.pitch_mm;
  std::vector<Misfit> misfits;
  std::vector<std::size_t> todo;
  for (const ColumnMisfit& first : columns) {
    const auto start = open.find(key(first.i, first.j));
    if (start == open.end()) continue;
    Misfit misfit;
    todo = {start->second};
    open.erase(start);
    while (!todo.empty()) {
      const ColumnMisfit& column = columns[todo.back()];
      todo.pop_back();
      const double cell = square * block.shares().of(column.i, column.j);
      misfit.area_mm2 += cell;
      misfit.volume_mm3 += cell * column.length_mm;
      if (column.depth_mm > misfit.depth_mm) {
        misfit.depth_mm = column.depth_mm;
        misfit.deepest_mm = {grid.x_mm(column.i), grid.y_mm(column.j), column.z_mm};
      }
      for (int di = -1; di <= 1; ++di)
        for (int dj = -1; dj <= 1; ++dj)
          if (const auto it = open.find(key(column.i + di, column.j + dj)); it != open.end()) {
            todo.push_back(it->second);
            open.erase(it);
          }
    }
    misfits.push_back(misfit);
  }
  return misfits;
}

// Returns the least distance of a point from a moving tool, or any value below `enough_mm` if one
// is reached. The speed of the farthest point of the tool bounds the steps.
double least_distance_mm(Vec3 point, const ProgramMotion& motion, const ToolProfile& profile,
                         double reach_mm, double enough_mm) {
  const Vec3 travel = motion.to.tip_mm - motion.from.tip_mm;
  const double speed = length(travel) + reach_mm * angle_between(normalized(motion.from.axis),
                                                                 normalized(motion.to.axis));
  double least = 1e300;
  for (double s = 0;;) {
    const Vec3 axis = normalized(turned_axis(motion.from.axis, motion.to.axis, s));
    const Vec3 from_tip = point - (motion.from.tip_mm + travel * s);
    const double height = dot(from_tip, axis);
    const double distance = profile.nearest(length(from_tip - axis * height), height).distance_mm;
    least = std::min(least, distance);
    if (least <= enough_mm || s >= 1 || speed == 0) return least;
    s = std::min(1.0, s + std::max(distance, kStepMinMm) / speed);
  }
}

Misfits ranked(std::vector<Misfit> misfits, double tolerance_mm) {
  Misfits all{.tolerance_mm = tolerance_mm, .count = misfits.size(), .worst = std::move(misfits)};
  std::ranges::stable_sort(all.worst, std::greater(), &Misfit::depth_mm);
  if (all.worst.size() > kMisfitsMax) all.worst.resize(kMisfitsMax);
  return all;
}

// Calls visit(i, j) for the columns of every tile that `selects`. Returns false if it was stopped.
template <class Selects, class Visit>
bool visit_columns(const DexelGrid& grid, const SearchControl& control, Selects&& selects,
                   Visit&& visit) {
  for (std::int32_t ty = 0; ty < grid.tiles_y(); ++ty) {
    if (control.progress) control.progress(static_cast<double>(ty) / grid.tiles_y());
    for (std::int32_t tx = 0; tx < grid.tiles_x(); ++tx) {
      if (control.stop.stop_requested()) return false;
      if (!selects(TileIndex{tx, ty})) continue;
      const std::int32_t j_end = std::min((ty + 1) * kTileSide, grid.columns_y);
      const std::int32_t i_end = std::min((tx + 1) * kTileSide, grid.columns_x);
      for (std::int32_t j = ty * kTileSide; j < j_end; ++j)
        for (std::int32_t i = tx * kTileSide; i < i_end; ++i) visit(i, j);
    }
  }
  return true;
}

}  // namespace

Misfits find_gouges(const DexelSnapshot& before, const DexelSnapshot& after, const PartModel& part,
                    double tolerance_mm, const SearchControl& control) {
  const DexelGrid& grid = after.grid();
  ColumnMisfits of_column(part, tolerance_mm);
  std::vector<ColumnMisfit> columns;
  const bool complete = visit_columns(
      grid, control, [&](TileIndex tile) { return after.touched(tile); },
      [&](std::int32_t i, std::int32_t j) {
        if (const auto column = of_column.gouge(before, after, i, j)) columns.push_back(*column);
      });
  if (!complete) return {};
  return ranked(joined(columns, after), tolerance_mm);
}

Misfits find_rests(const DexelSnapshot& block, const PartModel& part, double tolerance_mm,
                   double& loose_mm3, const SearchControl& control) {
  const DexelGrid& grid = block.grid();
  const AttachedMaterial attached(block, *part.material());
  loose_mm3 = attached.loose_mm3();
  ColumnMisfits of_column(part, tolerance_mm);
  std::vector<ColumnMisfit> columns;
  std::vector<Dexel> whole, kept;
  const bool complete = visit_columns(
      grid, control, [](TileIndex) { return true; },
      [&](std::int32_t i, std::int32_t j) {
        kept.clear();
        std::size_t n = 0;
        for (const Dexel& element : block.column(i, j, whole))
          if (attached.is_attached(i, j, n++)) kept.push_back(element);
        if (const auto column = of_column.rest(kept, i, j)) columns.push_back(*column);
      });
  if (!complete) return {};
  return ranked(joined(columns, block), tolerance_mm);
}

void attribute_gouges(Misfits& gouges, const std::vector<ProgramMotion>& motions,
                      const std::map<ToolId, SceneTool>& tools, double tolerance_mm,
                      const std::stop_token& stop) {
  std::map<ToolId, ToolProfile> profiles;
  for (const auto& [id, tool] : tools) profiles.emplace(id, ToolProfile(tool.tool));
  for (Misfit& gouge : gouges.worst) {
    double nearest = 1e300;
    for (std::size_t n = 0; n < motions.size() && nearest > tolerance_mm; ++n) {
      if (stop.stop_requested()) return;
      const Tool& tool = tools.at(motions[n].tool).tool;
      const double distance =
          least_distance_mm(gouge.deepest_mm, motions[n], profiles.at(motions[n].tool),
                            tool.length_mm + tool.radius_mm, tolerance_mm);
      if (distance >= nearest) continue;
      nearest = distance;
      gouge.motion = n;
    }
  }
}

void attribute_rests(Misfits& rests, const Scene& scene, const std::vector<ProgramMotion>& motions,
                     const std::stop_token& stop) {
  if (rests.worst.empty() || motions.empty()) return;
  // A motion farther away than the length of the block is not the cause.
  const BoxStock box = stock_bounds(scene.settings.stock);
  const TrueSolid cuts(box, scene.tools, motions, length(box.max_mm - box.min_mm));
  for (Misfit& rest : rests.worst) {
    if (stop.stop_requested()) return;
    const std::size_t motion = cuts.nearest_sweep(rest.deepest_mm);
    if (motion < motions.size()) rest.motion = motion;
  }
}

}  // namespace kerf
