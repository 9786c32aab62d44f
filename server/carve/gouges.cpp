// SPDX-License-Identifier: Apache-2.0
#include "server/carve/gouges.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "kernel/math/rotation.h"
#include "server/formats/machine_kinematics.h"
#include "server/verify/tool_profile.h"

namespace kerf {
namespace {

// A removed interval of a ray is sampled in steps of the distance to the reference, but at least
// this fraction of the pitch.
constexpr double kStepShare = 0.5;
// A motion is sampled in steps of the distance to the tool, but at least this, mm.
constexpr double kStepMinMm = 1e-3;

struct GougedColumn {
  std::int32_t i = 0, j = 0;
  double depth_mm = 0, z_mm = 0, length_mm = 0;
};

class Walker {
 public:
  Walker(const DexelSnapshot& before, const DexelSnapshot& after, const MeshDistance& reference,
         double tolerance_mm)
      : before_(before),
        after_(after),
        grid_(after.grid()),
        reference_(reference),
        tolerance_mm_(tolerance_mm) {}

  // Returns the gouge of the column, if any.
  std::optional<GougedColumn> column(std::int32_t i, std::int32_t j) {
    const auto was = before_.column(i, j, scratch_before_);
    const auto is = after_.column(i, j, scratch_after_);
    GougedColumn found{.i = i, .j = j};
    auto left = is.begin();
    for (const Dexel& whole : was) {
      std::int32_t bottom = whole.bottom;
      for (; left != is.end() && left->bottom < whole.top; ++left) {
        if (left->bottom > bottom) walk(found, bottom, left->bottom);
        bottom = left->top;
      }
      if (bottom < whole.top) walk(found, bottom, whole.top);
    }
    if (found.depth_mm <= tolerance_mm_) return std::nullopt;
    return found;
  }

 private:
  void walk(GougedColumn& found, std::int32_t bottom, std::int32_t top) {
    const double low = grid_.z_mm(bottom);
    const double high = grid_.z_mm(top);
    const double least = kStepShare * grid_.pitch_mm;
    for (double z = low; z <= high;) {
      const double distance =
          reference_.signed_distance_mm({grid_.x_mm(found.i), grid_.y_mm(found.j), z}, near_);
      const double step = std::max(std::abs(distance), least);
      if (distance < 0) found.length_mm += std::min(step, high - z);
      if (-distance > found.depth_mm) {
        found.depth_mm = -distance;
        found.z_mm = z;
      }
      // The end of the interval is sampled as well.
      z = z < high ? std::min(z + step, high) : high + 1;
    }
  }

  const DexelSnapshot& before_;
  const DexelSnapshot& after_;
  const DexelGrid& grid_;
  const MeshDistance& reference_;
  double tolerance_mm_;
  std::uint32_t near_ = 0;
  std::vector<Dexel> scratch_before_, scratch_after_;
};

std::uint64_t key(std::int32_t i, std::int32_t j) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) << 32) |
         static_cast<std::uint32_t>(j);
}

// Adjacent columns, including diagonal ones, form one gouge.
std::vector<Gouge> joined(const std::vector<GougedColumn>& columns, const DexelGrid& grid) {
  std::unordered_map<std::uint64_t, std::size_t> open;
  for (std::size_t n = 0; n < columns.size(); ++n) open.emplace(key(columns[n].i, columns[n].j), n);
  const double cell = grid.pitch_mm * grid.pitch_mm;
  std::vector<Gouge> gouges;
  std::vector<std::size_t> todo;
  for (const GougedColumn& first : columns) {
    const auto start = open.find(key(first.i, first.j));
    if (start == open.end()) continue;
    Gouge gouge;
    todo = {start->second};
    open.erase(start);
    while (!todo.empty()) {
      const GougedColumn& column = columns[todo.back()];
      todo.pop_back();
      gouge.area_mm2 += cell;
      gouge.volume_mm3 += cell * column.length_mm;
      if (column.depth_mm > gouge.depth_mm) {
        gouge.depth_mm = column.depth_mm;
        gouge.deepest_mm = {grid.x_mm(column.i), grid.y_mm(column.j), column.z_mm};
      }
      for (int di = -1; di <= 1; ++di)
        for (int dj = -1; dj <= 1; ++dj)
          if (const auto it = open.find(key(column.i + di, column.j + dj)); it != open.end()) {
            todo.push_back(it->second);
            open.erase(it);
          }
    }
    gouges.push_back(gouge);
  }
  return gouges;
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

}  // namespace

Gouges find_gouges(const DexelSnapshot& before, const DexelSnapshot& after,
                   const MeshDistance& reference, double tolerance_mm,
                   const std::function<void(double)>& progress, const std::stop_token& stop) {
  const DexelGrid& grid = after.grid();
  Walker walker(before, after, reference, tolerance_mm);
  std::vector<GougedColumn> columns;
  for (std::int32_t ty = 0; ty < grid.tiles_y(); ++ty) {
    if (progress) progress(static_cast<double>(ty) / grid.tiles_y());
    for (std::int32_t tx = 0; tx < grid.tiles_x(); ++tx) {
      if (stop.stop_requested()) return {};
      if (!after.touched({tx, ty})) continue;
      const std::int32_t j_end = std::min((ty + 1) * kTileSide, grid.columns_y);
      const std::int32_t i_end = std::min((tx + 1) * kTileSide, grid.columns_x);
      for (std::int32_t j = ty * kTileSide; j < j_end; ++j)
        for (std::int32_t i = tx * kTileSide; i < i_end; ++i)
          if (const auto column = walker.column(i, j)) columns.push_back(*column);
    }
  }
  Gouges gouges{.tolerance_mm = tolerance_mm, .worst = joined(columns, grid)};
  gouges.count = gouges.worst.size();
  std::ranges::sort(gouges.worst,
                    [](const Gouge& a, const Gouge& b) { return a.depth_mm > b.depth_mm; });
  if (gouges.worst.size() > kGougesMax) gouges.worst.resize(kGougesMax);
  return gouges;
}

void attribute_gouges(Gouges& gouges, const std::vector<ProgramMotion>& motions,
                      const std::map<ToolId, SceneTool>& tools, double tolerance_mm,
                      const std::stop_token& stop) {
  std::map<ToolId, ToolProfile> profiles;
  for (const auto& [id, tool] : tools) profiles.emplace(id, ToolProfile(tool.tool));
  for (Gouge& gouge : gouges.worst) {
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

}  // namespace kerf
