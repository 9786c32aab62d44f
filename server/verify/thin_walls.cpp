// SPDX-License-Identifier: Apache-2.0
#include "server/verify/thin_walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <tuple>

#include "server/verify/wall_probe.h"

namespace kerf {
namespace {

// Greatest distance of the true surface from the mesh: the distance to a ball of a pitch's diameter
// inside the solid, beyond which an edge may fall between the rays, + 0.65 pitches (target_bench
// laws).
constexpr double kMeshPitches = 0.65;
constexpr double kPitchStep = 1.1;
constexpr std::array kSides{SurfaceSide::kSolid, SurfaceSide::kVoid};
// Points of the stock's own surface within this many pitches count as one.
constexpr double kSamePlacePitches = 16;

// Whether a column within a pitch is solid, or void, at the point's height.
bool has_near(const DexelSnapshot& field, Vec3 point, SurfaceSide side) {
  const DexelGrid& grid = field.grid();
  const auto column = [&](double mm) {
    return static_cast<std::int32_t>(std::floor(mm / grid.pitch_mm));
  };
  const std::int32_t i = column(point.x - grid.origin_mm.x), j = column(point.y - grid.origin_mm.y);
  std::vector<Dexel> scratch;
  for (std::int32_t b = std::max(j - 1, 0); b <= std::min(j + 1, grid.columns_y - 1); ++b)
    for (std::int32_t a = std::max(i - 1, 0); a <= std::min(i + 1, grid.columns_x - 1); ++a) {
      if (std::hypot(grid.x_mm(a) - point.x, grid.y_mm(b) - point.y) >= grid.pitch_mm) continue;
      const bool solid = std::ranges::any_of(field.column(a, b, scratch), [&](const Dexel& dexel) {
        return grid.z_mm(dexel.bottom) <= point.z && point.z <= grid.z_mm(dexel.top);
      });
      if (solid == (side == SurfaceSide::kSolid)) return true;
    }
  return false;
}

}  // namespace

std::vector<ThinWall> find_thin_walls(const TrueSolid& solid, const CutSurface& surface,
                                      const ThinWallLimits& limits, const std::stop_token& stop,
                                      QueryEffort* effort) {
  const WallProbe probe(solid, limits, limits.pitch_mm, effort);
  std::vector<ThinWall> walls;
  for (const CutPoint& point : surface.points) {
    if (stop.stop_requested() || (effort != nullptr && effort->spent())) break;
    for (const SurfaceSide side : kSides)
      if (const auto wall = probe.wall_at(point, side)) walls.push_back(*wall);
  }
  std::ranges::stable_sort(walls, {}, &ThinWall::thickness_mm);
  return walls;
}

std::optional<double> pitch_for_walls(const TrueSolid& solid, const CutSurface& surface,
                                      const WallTarget& target, const std::stop_token& stop,
                                      QueryEffort* effort) {
  double pitch = target.pitch_mm;
  for (const CutPoint& point : surface.points) {
    const auto is_lost = [&] {
      const WallProbe probe(solid, {pitch, target.least_mm},
                            target.target_mm - kMeshPitches * pitch, effort);
      return std::ranges::any_of(
          kSides, [&](SurfaceSide side) { return probe.thin_at(point, side).has_value(); });
    };
    while (!stop.stop_requested() && is_lost()) {
      pitch /= kPitchStep;
      if (pitch < target.pitch_mm * kFinestWallShare) return std::nullopt;
    }
  }
  return pitch;
}

std::vector<ThinWall> distinct_walls(const std::vector<ThinWall>& walls,
                                     const std::vector<std::uint64_t>& place_of_sweep,
                                     double pitch_mm) {
  const auto place = [&](std::uint32_t sweep) {
    return sweep < place_of_sweep.size() ? place_of_sweep[sweep] : UINT64_MAX;
  };
  std::set<std::tuple<bool, std::uint64_t, std::uint64_t>> seen;
  std::vector<ThinWall> distinct;
  for (const ThinWall& wall : walls) {
    const auto [first, second] = std::minmax({place(wall.sweep), place(wall.other_sweep)});
    const bool of_stock = first == UINT64_MAX;
    const bool known = of_stock ? std::ranges::any_of(distinct,
                                                      [&](const ThinWall& other) {
                                                        return other.groove == wall.groove &&
                                                               place(other.sweep) == UINT64_MAX &&
                                                               length(other.mm - wall.mm) <
                                                                   kSamePlacePitches * pitch_mm;
                                                      })
                                : !seen.emplace(wall.groove, first, second).second;
    if (!known) distinct.push_back(wall);
  }
  return distinct;
}

void mark_missing(std::vector<ThinWall>& walls, const DexelSnapshot& after) {
  for (ThinWall& wall : walls)
    wall.missing =
        !has_near(after, wall.mm, wall.groove ? SurfaceSide::kVoid : SurfaceSide::kSolid);
}

}  // namespace kerf
