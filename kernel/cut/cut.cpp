// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/cut.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "kernel/cut/block_places.h"
#include "kernel/cut/tile_cutter.h"
#include "kernel/dexel/dexel_tile.h"

namespace kerf {
namespace {

/// Cost of evaluating one piece over a block of 8 x 8 columns, relative to a ball's (measured:
/// kernel/cut/README.md, "Threads").
struct WorkPerBlock {
  double operator()(const BallSweep&) const { return 1; }
  double operator()(const FrustumTranslation&) const { return 4; }
  double operator()(const ArcTranslation&) const { return 6; }
  double operator()(const TurningSweep&) const { return 20; }
};
/// Work, in blocks of a ball, from which on several threads are used. Less takes about as long as
/// waking another thread.
constexpr double kWorkForThreads = 400;
/// Jobs per thread. More balance the varying cost of blocks; fewer reduce the overhead per job.
constexpr int kJobsPerThread = 8;

struct ColumnRange {
  std::int32_t first, last;  ///< inclusive; empty when first > last
};

/// Returns the columns whose ray lies in [lo, hi], widened to whole columns: the sweep makes the
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

Lanes lower_bound(const SweptTool& swept, const Discs& discs) {
  Lanes z = Lanes(std::numeric_limits<double>::infinity());
  for (const SweptPiece& piece : swept.pieces) {
    std::visit([&](const auto& s) { s.lower_bound(discs, z); }, piece);
  }
  return z;
}

/// Finds the tiles of a run that a sweep may change, in tile order.
class Reach {
 public:
  Reach(const DexelField& field, const SweptTool& swept, TileRun run = {})
      : field_(field), grid_(field.grid()), swept_(swept), run_(run) {}

  /// Number of tiles in the bounds of the sweep; known after find().
  std::int64_t in_bounds() const { return in_bounds_; }

  std::vector<ReachedTile> find() {
    const SweepBounds b = bounds_of(swept_);
    const double top_mm = grid_.z_mm(grid_.height_quanta);
    if (!(b.max_mm.z > grid_.origin_mm.z && b.min_mm.z < top_mm)) return {};
    const ColumnRange is =
        columns_in(b.min_mm.x, b.max_mm.x, grid_.origin_mm.x, grid_.pitch_mm, grid_.columns_x);
    const ColumnRange js =
        columns_in(b.min_mm.y, b.max_mm.y, grid_.origin_mm.y, grid_.pitch_mm, grid_.columns_y);
    if (is.first > is.last || js.first > js.last) return {};
    const std::int32_t first = is.first / kTileSide, last = is.last / kTileSide;
    const std::int32_t low = js.first / kTileSide, high = js.last / kTileSide;
    const std::int64_t width = last - first + 1;
    in_bounds_ = width * (high - low + 1);
    const std::int64_t end = std::min(in_bounds_, run_.first + run_.count);
    for (std::int64_t at = run_.first; at < end;) {
      const std::int64_t y = at / width, x = at % width;
      const std::int64_t count = std::min({std::int64_t{kLanes}, width - x, end - at});
      add_tiles({first + static_cast<std::int32_t>(x), low + static_cast<std::int32_t>(y)},
                static_cast<int>(count));
      at += count;
    }
    return std::move(reached_);
  }
  /// Finds those of these tiles that the sweep may change.
  std::vector<ReachedTile> find(std::span<const TileIndex> tiles) {
    for (const TileIndex tile : tiles) add(tile);
    return std::move(reached_);
  }

 private:
  /// Adds those of up to eight neighboring tiles of a row that the sweep reaches.
  void add_tiles(TileIndex first, int count) {
    Discs discs;
    Lanes reached_below;
    place_tiles(grid_, first, discs, reached_below);
    const unsigned reached = lanes_below(lower_bound(swept_, discs), reached_below);
    for (int i = 0; i < count; ++i) {
      if ((reached >> i & 1) != 0) add({first.x + i, first.y});
    }
  }
  void add(TileIndex at) {
    ReachedTile tile{at, field_.find(at), 0};
    const std::int32_t* tops = tile.stored != nullptr ? tile.stored->block_top.data() : nullptr;
    // Each half is two rows of four blocks.
    for (int half = 0; half < 2; ++half) {
      Discs discs;
      Lanes reached_below;
      place_blocks(grid_, at, half, tops, discs, reached_below);
      tile.blocks |= lanes_below(lower_bound(swept_, discs), reached_below) << (half * kLanes);
    }
    if (tile.blocks != 0) reached_.push_back(tile);
  }

  const DexelField& field_;
  const DexelGrid& grid_;
  const SweptTool& swept_;
  TileRun run_;
  std::int64_t in_bounds_ = 0;
  std::vector<ReachedTile> reached_;
};

int blocks_of(const ReachedTile& tile) { return std::popcount(tile.blocks); }

std::int64_t blocks_of(std::span<const ReachedTile> tiles) {
  std::int64_t blocks = 0;
  for (const ReachedTile& tile : tiles) blocks += blocks_of(tile);
  return blocks;
}

/// Estimates the work of a sweep, in blocks of a ball.
double work_of(std::span<const ReachedTile> tiles, const SweptTool& swept) {
  double per_block = 0;
  for (const SweptPiece& piece : swept.pieces) per_block += std::visit(WorkPerBlock{}, piece);
  return double(blocks_of(tiles)) * per_block;
}

/// Divides the tiles into runs with about equal numbers of blocks.
std::vector<std::span<const ReachedTile>> divide(std::span<const ReachedTile> tiles, int workers) {
  const std::int64_t blocks = blocks_of(tiles), jobs = std::int64_t{workers} * kJobsPerThread;
  std::vector<std::span<const ReachedTile>> runs;
  std::size_t begin = 0;
  std::int64_t done = 0;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    done += blocks_of(tiles[i]);
    if (done * jobs < blocks * std::int64_t(runs.size() + 1)) continue;
    runs.push_back(tiles.subspan(begin, i + 1 - begin));
    begin = i + 1;
  }
  return runs;
}

}  // namespace

std::int64_t cut(DexelField& field, const SweptTool& swept, Removal& removal, Workers& workers,
                 NormalCode end_code, TileRun tiles) {
  removal.start(0);
  if (swept.pieces.empty()) return 0;
  Reach reach(field, swept, tiles);
  const std::vector<ReachedTile> reached = reach.find();
  if (reached.empty()) return reach.in_bounds();
  if (workers.count() == 1 || work_of(reached, swept) < kWorkForThreads) {
    TileCutter cutter(field, swept, end_code, removal.start(1).front());
    for (const ReachedTile& tile : reached) cutter.cut(tile);
    cutter.put_tiles();
    return reach.in_bounds();
  }
  const auto runs = divide(reached, workers.count());
  const std::span<RemovedPart> parts = removal.start(runs.size());
  std::vector<TileCutter> cutters;
  cutters.reserve(runs.size());
  for (RemovedPart& part : parts) cutters.emplace_back(field, swept, end_code, part);
  const auto cut_run = [&](int run) {
    for (const ReachedTile& tile : runs[std::size_t(run)]) cutters[std::size_t(run)].cut(tile);
  };
  workers.run(static_cast<int>(runs.size()), cut_run);
  // Only this thread changes the tile directory.
  for (TileCutter& cutter : cutters) cutter.put_tiles();
  return reach.in_bounds();
}

void cut_tiles(DexelField& field, const SweptTool& swept, std::span<const TileIndex> tiles,
               Removal& removal, NormalCode end_code) {
  removal.start(0);
  if (swept.pieces.empty()) return;
  const std::vector<ReachedTile> reached = Reach(field, swept).find(tiles);
  if (reached.empty()) return;
  TileCutter cutter(field, swept, end_code, removal.start(1).front());
  for (const ReachedTile& tile : reached) cutter.cut(tile);
  cutter.put_tiles();
}

}  // namespace kerf
