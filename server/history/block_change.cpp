// SPDX-License-Identifier: Apache-2.0
// The part of BlockHistory that undoes and redoes strokes.
#include <algorithm>
#include <utility>

#include "kernel/dexel/common_solid.h"
#include "kernel/dexel/dexel_tile.h"
#include "server/history/block_history.h"

namespace kerf {
namespace {

using Tile = std::shared_ptr<const DexelTile>;

Tile tile_of(const SolidSnapshot& solid, FieldTile at) {
  const auto field = std::ranges::find(solid.fields, at.axis,
                                       [](const DexelSnapshot& f) { return f.grid().axis; });
  return field->tiles().share(at.tile);
}

std::uint64_t records_of(std::span<const MotionRun> runs) {
  std::uint64_t sum = 0;
  for (const MotionRun& run : runs) sum += run.last - run.first + 1;
  return sum;
}

/// A copy that no field owns.
std::shared_ptr<DexelTile> copy_of(const DexelTile& tile) {
  auto copy = std::make_shared<DexelTile>(tile);
  copy->era = 0;
  return copy;
}

}  // namespace

/// A tile that the changed strokes may reach.
struct BlockHistory::ChangedTile {
  FieldTile at;
  Tile now;                            ///< null: untouched stock
  std::vector<MotionRun> undone = {};  ///< of the changed strokes
  std::vector<MotionRun> redone = {};
  std::vector<const MotionSpan*> others = {};  ///< of the set, without the changed strokes
  std::uint64_t others_records = 0;
};

/// Finds the motions that reach each tile: the undone ones, the redone ones, and all others.
std::vector<BlockHistory::ChangedTile> BlockHistory::changed_tiles(const SolidSnapshot& solid,
                                                                   std::span<const FieldTile> tiles,
                                                                   const StrokeSet& changed,
                                                                   const MotionSet& set) const {
  std::vector<ChangedTile> list;
  for (const FieldTile at : tiles) {
    ChangedTile& tile = list.emplace_back(ChangedTile{at, tile_of(solid, at)});
    const Bounds box = tile_bounds(grid(at.axis), at.tile);
    for (const MotionSpan& span : spans_.all()) {
      if (span.run.first > set.last) break;
      if (!span.meets(box)) continue;
      const bool changes = changed.contains(span.run.stroke);
      const bool is_left_out = set.without.contains(span.run.stroke);
      if (changes) {
        (is_left_out ? tile.undone : tile.redone).push_back(span.run);
      } else if (!is_left_out) {
        tile.others.push_back(&span);
        tile.others_records += span.run.last - span.run.first + 1;
      }
    }
  }
  return list;
}

/// Finds the returning stock of each tile: removed by the undone motions and by no other. If the
/// other motions are fewer, starts from everything missing from the tile instead.
std::expected<std::vector<Tile>, std::string> BlockHistory::find_returning(
    std::vector<ChangedTile>& tiles, const MotionSet& set, Workers& workers,
    const std::stop_token& stop) {
  std::vector<GroupJob> jobs;
  std::vector<std::size_t> job_of(tiles.size(), SIZE_MAX);
  for (std::size_t n = 0; n < tiles.size(); ++n) {
    ChangedTile& tile = tiles[n];
    if (!tile.now || tile.undone.empty() || tile.others_records < records_of(tile.undone)) continue;
    job_of[n] = jobs.size();
    jobs.push_back({.at = tile.at, .last = set.last, .runs = std::move(tile.undone)});
  }
  // Ends made by these motions only do not stay, so their normals are not needed.
  if (auto ok = shape_carver_.carve(jobs, motions_, workers, stop); !ok) {
    return std::unexpected(ok.error());
  }
  std::vector<ReturnJob> returns(tiles.size());
  workers.run(static_cast<int>(tiles.size()), [&](int number) {
    const auto n = static_cast<std::size_t>(number);
    ChangedTile& tile = tiles[n];
    returns[n] = {tile.at, nullptr, std::move(tile.others)};
    const bool looks_at_all = job_of[n] == SIZE_MAX && !tile.undone.empty();
    const Tile left = looks_at_all            ? tile.now
                      : job_of[n] != SIZE_MAX ? jobs[job_of[n]].tile
                                              : nullptr;
    if (!left) return;
    const auto removed = carver_.copy_of_start(tile.at);
    remove_common(*removed, *left);
    returns[n].stock = removed;
  });
  if (auto ok = return_carver_.carve(returns, set.last, motions_, workers, stop); !ok) {
    return std::unexpected(ok.error());
  }
  std::vector<Tile> found;
  for (ReturnJob& job : returns) found.push_back(std::move(job.stock));
  return found;
}

std::expected<std::vector<TileReplacement>, std::string> BlockHistory::change(
    const SolidSnapshot& solid, std::span<const FieldTile> reached, const StrokeSet& changed,
    const MotionSet& set, Workers& workers, const std::stop_token& stop) {
  std::vector<ChangedTile> tiles = changed_tiles(solid, reached, changed, set);
  const auto returning = find_returning(tiles, set, workers, stop);
  if (!returning) return std::unexpected(returning.error());
  std::vector<TileReplacement> result;
  std::vector<GroupJob> jobs;
  for (std::size_t n = 0; n < tiles.size(); ++n) {
    ChangedTile& tile = tiles[n];
    Tile now = tile.now;
    if (const Tile& back = (*returning)[n]) {
      auto with = copy_of(*now);
      add_solid(*with, *back);
      now = std::move(with);
    }
    if (!tile.redone.empty()) {
      jobs.push_back(
          {.at = tile.at, .last = set.last, .runs = std::move(tile.redone), .from = now});
    }
    if (now != tile.now) result.push_back({tile.at, std::move(now)});
  }
  if (auto ok = carver_.carve(jobs, motions_, workers, stop); !ok) {
    return std::unexpected(ok.error());
  }
  for (GroupJob& job : jobs) {
    if (!job.tile) continue;
    const auto same = std::ranges::lower_bound(result, job.at, {}, &TileReplacement::at);
    if (same != result.end() && same->at == job.at) {
      same->tile = std::move(job.tile);
    } else {
      result.insert(same, {job.at, std::move(job.tile)});
    }
  }
  return result;
}

}  // namespace kerf
