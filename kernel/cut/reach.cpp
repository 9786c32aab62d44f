// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/reach.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <variant>

#include "kernel/cut/block_places.h"

namespace kerf {
namespace {

struct ColumnRange {
  std::int32_t first, last;  ///< inclusive; empty when first > last
};

/// Returns the columns whose ray is in [lo, hi], widened to whole columns. The sweep makes the
/// exact test.
ColumnRange columns_in(double lo_mm, double hi_mm, double origin_mm, double pitch_mm,
                       std::int32_t columns) {
  const double first = std::floor((lo_mm - origin_mm) / pitch_mm - 0.5);
  const double last = std::ceil((hi_mm - origin_mm) / pitch_mm - 0.5);
  return {static_cast<std::int32_t>(std::clamp(first, 0.0, double(columns))),
          static_cast<std::int32_t>(std::clamp(last, -1.0, double(columns) - 1))};
}

SweepBounds bounds_of(const SweptTool& swept) {
  SweepBounds all{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
  for (const SweptPiece& piece : swept.pieces) {
    const SweepBounds b =
        std::visit([](const auto& s) -> SweepBounds { return s.bounds(); }, piece);
    all.min_mm = {std::min(all.min_mm.x, b.min_mm.x), std::min(all.min_mm.y, b.min_mm.y),
                  std::min(all.min_mm.z, b.min_mm.z)};
    all.max_mm = {std::max(all.max_mm.x, b.max_mm.x), std::max(all.max_mm.y, b.max_mm.y),
                  std::max(all.max_mm.z, b.max_mm.z)};
  }
  return all;
}

/// Returns the discs over which the tool may change stock above `reached_below`.
unsigned changed_discs(const SweptTool& swept, const Discs& discs, const Lanes& reached_below) {
  ToolReach reach;
  for (std::size_t k = 0; k < swept.pieces.size(); ++k) {
    PieceBounds b;
    const auto bound = [&](const auto& s) { return s.lower_bound(discs, b.lowest_mm); };
    b.left_out = std::visit(bound, swept.pieces[k]);
    b.reached = lanes_below(b.lowest_mm, reached_below);
    reach.add(b, lanes_below(b.lowest_mm, reached_below + swept.join_mm));
  }
  return reach.discs();
}

}  // namespace

ReachSize find_tiles(const DexelGrid& grid, const SweptTool& swept, const TileRun& run,
                     std::vector<TileIndex>& tiles) {
  if (swept.pieces.empty()) return {};
  const SweepBounds b = bounds_of(swept);
  const double top_mm = grid.z_mm(grid.height_quanta);
  if (!(b.max_mm.z > grid.origin_mm.z && b.min_mm.z < top_mm)) return {};
  const ColumnRange is =
      columns_in(b.min_mm.x, b.max_mm.x, grid.origin_mm.x, grid.pitch_mm, grid.columns_x);
  const ColumnRange js =
      columns_in(b.min_mm.y, b.max_mm.y, grid.origin_mm.y, grid.pitch_mm, grid.columns_y);
  if (is.first > is.last || js.first > js.last) return {};
  const std::int32_t first = is.first / kTileSide, last = is.last / kTileSide;
  const std::int32_t low = js.first / kTileSide, high = js.last / kTileSide;
  const std::int64_t width = last - first + 1;
  const std::int64_t in_bounds = width * (high - low + 1);
  const std::int64_t end = std::min(in_bounds, run.first + run.count);
  for (std::int64_t at = run.first; at < end;) {
    const std::int64_t y = at / width, x = at % width;
    const std::int64_t count = std::min({std::int64_t{kLanes}, width - x, end - at});
    const TileIndex corner{first + static_cast<std::int32_t>(x),
                           low + static_cast<std::int32_t>(y)};
    Discs discs;
    Lanes reached_below;
    place_tiles(grid, corner, discs, reached_below);
    const unsigned reached = changed_discs(swept, discs, reached_below);
    for (int i = 0; i < static_cast<int>(count); ++i) {
      if ((reached >> i & 1) != 0) tiles.push_back({corner.x + i, corner.y});
    }
    at += count;
  }
  const std::int64_t blocks = std::int64_t{is.last / kBlockSide - is.first / kBlockSide + 1} *
                              (js.last / kBlockSide - js.first / kBlockSide + 1);
  return {in_bounds, blocks};
}

unsigned find_blocks(const DexelGrid& grid, const SweptTool& swept, TileIndex tile,
                     const DexelTile* stored) {
  const std::int32_t* tops = stored != nullptr ? stored->block_top.data() : nullptr;
  unsigned blocks = 0;
  // Each half has two rows of four blocks.
  for (int half = 0; half < 2; ++half) {
    Discs discs;
    Lanes reached_below;
    place_blocks(grid, tile, half, tops, discs, reached_below);
    blocks |= changed_discs(swept, discs, reached_below) << (half * kLanes);
  }
  return blocks;
}

}  // namespace kerf
