// SPDX-License-Identifier: Apache-2.0
#include "kernel/motion_reach.h"

#include <algorithm>
#include <utility>

#include "kernel/dexel/tile_region.h"
#include "kernel/sculpture_motion.h"

namespace kerf {
namespace {

/// Tiles of one field from which on a motion is divided.
constexpr std::int64_t kTilesUndivided = 16;
/// Divisions of a motion into halves, at most.
constexpr int kDepthMax = 12;

/// Returns a box around what a cylinder on the tool's axis passes.
Bounds swept_box(const Extent& whole, const ToolMotion& motion) {
  const auto [from, to] = std::pair(motion.from, motion.to);
  if (motion.turn_rad == 0) {
    return joined(cylinder_bounds(whole, from.tip_mm, from.axis),
                  cylinder_bounds(whole, to.tip_mm, to.axis));
  }
  // Between its poses an axis that turns leaves the hull of both by the sagitta of its arc at most.
  const double sagitta_mm = whole.z1_mm * motion.turn_rad * motion.turn_rad / 8;
  Bounds box{from.tip_mm + from.axis * whole.z0_mm, from.tip_mm + from.axis * whole.z0_mm};
  for (const ToolPose& pose : {from, to}) {
    const Vec3 low_mm = pose.tip_mm + pose.axis * whole.z0_mm;
    const Vec3 top_mm = pose.tip_mm + pose.axis * whole.z1_mm;
    box = joined(box, joined({low_mm, low_mm}, {top_mm, top_mm}));
  }
  return grown(box, whole.radius_mm + sagitta_mm);
}

void add_reach(const Tool& tool, const ToolMotion& motion, const DexelGrid& grid, double margin_mm,
               int depth, std::vector<FieldTile>& tiles) {
  const Bounds box = grown(reach_of(tool, motion), margin_mm);
  const TileRegion region = tiles_through(grid, box.lo_mm, box.hi_mm);
  if (region.count() > kTilesUndivided && depth < kDepthMax) {
    // Halves that are shorter than the tool is wide reach the same tiles.
    const double half_mm = motion.travel_mm / 2;
    if (half_mm > tool.radius_mm && half_mm > kTileSide * grid.pitch_mm) {
      const ToolPose middle = motion.at(0.5);
      for (const auto& [from, to] : {std::pair{motion.from, middle}, {middle, motion.to}}) {
        add_reach(tool, make_motion(from, to, tool.length_mm), grid, margin_mm, depth + 1, tiles);
      }
      return;
    }
  }
  region.all_of([&](TileIndex tile) {
    tiles.push_back({grid.axis, tile});
    return true;
  });
}

}  // namespace

Bounds reach_of(const Tool& tool, const ToolMotion& motion) {
  return swept_box({0, tool.length_mm, tool.radius_mm}, motion);
}

Bounds non_cutting_reach(const Tool& tool, const ToolMotion& motion) {
  Extent whole = extent(tool.non_cutting.front());
  for (const ToolPiece& piece : tool.non_cutting) {
    const Extent e = extent(piece);
    whole = {std::min(whole.z0_mm, e.z0_mm), std::max(whole.z1_mm, e.z1_mm),
             std::max(whole.radius_mm, e.radius_mm)};
  }
  return swept_box(whole, motion);
}

Bounds reach_of(const Tool& tool, const MoveTool& motion) {
  return reach_of(tool, motion_of(motion, tool));
}

void find_reach(const Tool& tool, const MoveTool& move, std::span<const DexelGrid> grids,
                double tolerance_mm, std::vector<FieldTile>& tiles) {
  tiles.clear();
  const ToolMotion motion = motion_of(move, tool);
  for (const DexelGrid& grid : grids) {
    // Ends are rounded to a quantum, and lie within the tolerance of the true sweep.
    add_reach(tool, motion, grid, tolerance_mm + grid.z_quantum_mm, 0, tiles);
  }
  std::ranges::sort(tiles);
  tiles.erase(std::ranges::unique(tiles).begin(), tiles.end());
}

}  // namespace kerf
