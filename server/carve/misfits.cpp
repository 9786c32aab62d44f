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
#include "server/verify/tool_profile.h"
#include "server/verify/true_solid.h"

namespace kerf {
namespace {

// A removed interval of a ray is sampled in steps of the distance to the reference, but at least
// this fraction of the pitch.
constexpr double kStepShare = 0.5;
// A motion is sampled in steps of the distance to the tool, but at least this, mm.
constexpr double kStepMinMm = 1e-3;

struct MisfitColumn {
  std::int32_t i = 0, j = 0;
  double depth_mm = 0, z_mm = 0, length_mm = 0;
};

using Elements = std::vector<Dexel>;

// Stores in `rest` what is in `whole` and not in `taken`.
void subtract(std::span<const Dexel> whole, std::span<const Dexel> taken, Elements& rest) {
  rest.clear();
  auto first = taken.begin();
  for (const Dexel& element : whole) {
    std::int32_t bottom = element.bottom;
    while (first != taken.end() && first->top <= bottom) ++first;
    for (auto at = first; at != taken.end() && at->bottom < element.top; ++at) {
      if (at->bottom > bottom) rest.push_back({bottom, at->bottom});
      bottom = std::max(bottom, at->top);
    }
    if (bottom < element.top) rest.push_back({bottom, element.top});
  }
}

void intersect(std::span<const Dexel> a, std::span<const Dexel> b, Elements& common) {
  common.clear();
  for (auto x = a.begin(), y = b.begin(); x != a.end() && y != b.end();) {
    const Dexel both{std::max(x->bottom, y->bottom), std::min(x->top, y->top)};
    if (both.bottom < both.top) common.push_back(both);
    x->top < y->top ? ++x : ++y;
  }
}

/// Measures columns of a block against a part.
class Walker {
 public:
  Walker(const DexelGrid& grid, const PartModel& part, double tolerance_mm)
      : grid_(grid), part_(part), tolerance_mm_(tolerance_mm) {}

  // Returns the gouge of the column, if any.
  std::optional<MisfitColumn> gouge(const DexelSnapshot& before, const DexelSnapshot& after,
                                    std::int32_t i, std::int32_t j) {
    subtract(before.column(i, j, whole_), after.column(i, j, left_), removed_);
    if (part_.material() == nullptr) return walk(removed_, -1, i, j);
    intersect(removed_, part_.material()->column(i, j, of_part_), parts_);
    return walk(parts_, -1, i, j);
  }

  // Returns the rest of the column, if any.
  std::optional<MisfitColumn> rest(const DexelSnapshot& block, const AttachedMaterial& attached,
                                   std::int32_t i, std::int32_t j) {
    removed_.clear();
    std::size_t n = 0;
    for (const Dexel& element : block.column(i, j, whole_))
      if (attached.is_attached(i, j, n++)) removed_.push_back(element);
    subtract(removed_, part_.material()->column(i, j, of_part_), parts_);
    return walk(parts_, 1, i, j);
  }

 private:
  // `side`: 1 outside the part, -1 inside.
  std::optional<MisfitColumn> walk(const Elements& parts, double side, std::int32_t i,
                                   std::int32_t j) {
    MisfitColumn found{.i = i, .j = j};
    for (const Dexel& element : parts)
      if (!is_shallow(element)) walk(found, element, side);
    if (found.depth_mm <= tolerance_mm_) return std::nullopt;
    return found;
  }

  // Nothing is farther from the part's surface than from the end that lies on it.
  bool is_shallow(const Dexel& element) const {
    if ((element.top - element.bottom) * grid_.z_quantum_mm > tolerance_mm_) return false;
    return std::ranges::any_of(of_part_, [&](const Dexel& d) {
      return d.bottom == element.bottom || d.top == element.top || d.top == element.bottom ||
             d.bottom == element.top;
    });
  }

  void walk(MisfitColumn& found, const Dexel& element, double side) {
    const double low = grid_.z_mm(element.bottom);
    const double high = grid_.z_mm(element.top);
    const double least = kStepShare * grid_.pitch_mm;
    for (double z = low; z <= high;) {
      const double depth = side * part_.surface().signed_distance_mm(
                                      {grid_.x_mm(found.i), grid_.y_mm(found.j), z}, near_);
      const double step = std::max(std::abs(depth), least);
      if (depth > 0) found.length_mm += std::min(step, high - z);
      if (depth > found.depth_mm) {
        found.depth_mm = depth;
        found.z_mm = z;
      }
      // The end of the interval is sampled as well.
      z = z < high ? std::min(z + step, high) : high + 1;
    }
  }

  const DexelGrid& grid_;
  const PartModel& part_;
  double tolerance_mm_;
  std::uint32_t near_ = 0;
  Elements whole_, left_, removed_, of_part_, parts_;
};

std::uint64_t key(std::int32_t i, std::int32_t j) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) << 32) |
         static_cast<std::uint32_t>(j);
}

// Adjacent columns, including diagonal ones, form one misfit.
std::vector<Misfit> joined(const std::vector<MisfitColumn>& columns, const DexelGrid& grid) {
  std::unordered_map<std::uint64_t, std::size_t> open;
  for (std::size_t n = 0; n < columns.size(); ++n) open.emplace(key(columns[n].i, columns[n].j), n);
  const double cell = grid.pitch_mm * grid.pitch_mm;
  std::vector<Misfit> misfits;
  std::vector<std::size_t> todo;
  for (const MisfitColumn& first : columns) {
    const auto start = open.find(key(first.i, first.j));
    if (start == open.end()) continue;
    Misfit misfit;
    todo = {start->second};
    open.erase(start);
    while (!todo.empty()) {
      const MisfitColumn& column = columns[todo.back()];
      todo.pop_back();
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
// is reached. No point moves faster than the farthest point of the tool, which bounds the steps.
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
  Walker walker(grid, part, tolerance_mm);
  std::vector<MisfitColumn> columns;
  const bool complete = visit_columns(
      grid, control, [&](TileIndex tile) { return after.touched(tile); },
      [&](std::int32_t i, std::int32_t j) {
        if (const auto column = walker.gouge(before, after, i, j)) columns.push_back(*column);
      });
  if (!complete) return {};
  return ranked(joined(columns, grid), tolerance_mm);
}

Misfits find_rests(const DexelSnapshot& block, const PartModel& part, double tolerance_mm,
                   double& loose_mm3, const SearchControl& control) {
  const DexelGrid& grid = block.grid();
  const AttachedMaterial attached(block, *part.material());
  loose_mm3 = attached.loose_mm3();
  Walker walker(grid, part, tolerance_mm);
  std::vector<MisfitColumn> columns;
  const bool complete = visit_columns(
      grid, control, [](TileIndex) { return true; },
      [&](std::int32_t i, std::int32_t j) {
        if (const auto column = walker.rest(block, attached, i, j)) columns.push_back(*column);
      });
  if (!complete) return {};
  return ranked(joined(columns, grid), tolerance_mm);
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
  // A motion farther away than the block is long is not the cause.
  const BoxStock box = stock_bounds(scene.settings.stock);
  const TrueSolid cuts(box, scene.tools, motions, length(box.max_mm - box.min_mm));
  for (Misfit& rest : rests.worst) {
    if (stop.stop_requested()) return;
    const std::size_t motion = cuts.nearest_sweep(rest.deepest_mm);
    if (motion < motions.size()) rest.motion = motion;
  }
}

}  // namespace kerf
