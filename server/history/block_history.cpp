// SPDX-License-Identifier: Apache-2.0
#include "server/history/block_history.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "kernel/dexel/common_solid.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/tile_region.h"
#include "kernel/motion_reach.h"

namespace kerf {
namespace {

/// Greatest growth of a span beyond its first motion, tiles.
constexpr double kSpanTiles = 2;

/// The strokes of some runs that a set excludes; ascending.
std::vector<StrokeId> left_out(std::span<const MotionRun> runs, const StrokeSet& without) {
  std::vector<StrokeId> out;
  for (const MotionRun& run : runs) {
    if (without.contains(run.stroke)) out.push_back(run.stroke);
  }
  std::ranges::sort(out);
  out.erase(std::ranges::unique(out).begin(), out.end());
  return out;
}

SculptureSettings without_normals(SculptureSettings settings) {
  settings.keep_normals = false;
  return settings;
}

template <class Tile>
void sort_unique(std::vector<Tile>& tiles) {
  std::ranges::sort(tiles);
  tiles.erase(std::ranges::unique(tiles).begin(), tiles.end());
}

}  // namespace

/// An era that contributes to an answer.
struct BlockHistory::Wanted {
  static constexpr std::size_t kKept = SIZE_MAX;
  FieldTile at;
  EraTile* era;
  std::size_t job = kKept;  ///< kKept: the stored tile of the era is valid
  bool is_whole = true;     ///< the set has the era up to its end
  std::uint64_t last = 0;   ///< record of the era's last motion that meets the tile
  std::vector<StrokeId> without = {};
};

BlockHistory::BlockHistory(std::unique_ptr<RecordSource> journal, const SculptureSettings& settings,
                           const SolidSnapshot& start, HistoryMemory memory)
    : motions_(std::move(journal), memory.windows),
      carver_(settings, start),
      shape_carver_(without_normals(settings), start),
      return_carver_(settings, start),
      shape_settings_(without_normals(settings)),
      start_(start),
      tolerance_mm_(settings.tolerance_mm),
      spans_(kSpanTiles * kTileSide * settings.pitch_mm),
      tile_bytes_max_(memory.tile_bytes) {
  for (const DexelSnapshot& field : start.fields) {
    grids_.push_back(field.grid());
    margin_mm_ = std::max(margin_mm_, tolerance_mm_ + field.grid().z_quantum_mm);
  }
}

const DexelGrid& BlockHistory::grid(RayAxis axis) const {
  return *std::ranges::find(grids_, axis, &DexelGrid::axis);
}

std::expected<void, std::string> BlockHistory::catch_up(const std::stop_token& stop) {
  auto ok = motions_.catch_up(
      [this](std::uint64_t record, const RecordedMotion& motion) {
        spans_.add(record, motion.stroke, grown(reach_of(*motion.tool, motion.motion), margin_mm_));
      },
      stop);
  eras_.grow(last());
  return ok;
}

std::expected<std::vector<FieldTile>, std::string> BlockHistory::reach(
    const StrokeSet& strokes, const std::stop_token& stop) {
  std::vector<FieldTile> all;
  for (const StrokeId id : strokes) {
    const Stroke* stroke = this->strokes().find(id);
    if (stroke == nullptr) continue;
    for (std::uint64_t record = id; record <= stroke->last;) {
      const std::uint64_t first = RecordedMotions::window_begin(record);
      const auto windows = motions_.windows({&first, 1}, stop);
      if (!windows) return std::unexpected(windows.error());
      const RecordedMotions::Window& window = *windows->front();
      const std::uint64_t end = std::min(first + window.motions.size(), stroke->last + 1);
      for (; record < end; ++record) {
        const RecordedMotion& motion = window.motions[record - first];
        if (motion.tool == nullptr || motion.stroke != id) continue;
        find_reach(*motion.tool, motion.motion, grids_, tolerance_mm_, reached_);
        all.insert(all.end(), reached_.begin(), reached_.end());
      }
      sort_unique(all);
    }
  }
  return all;
}

std::vector<FieldTile> BlockHistory::tiles() const {
  std::vector<FieldTile> all;
  for (const DexelGrid& grid : grids_) {
    std::vector<bool> reached(static_cast<std::size_t>(grid.tiles_x()) *
                              static_cast<std::size_t>(grid.tiles_y()));
    const auto place = [&](TileIndex tile) {
      return static_cast<std::size_t>(tile.x) * static_cast<std::size_t>(grid.tiles_y()) +
             static_cast<std::size_t>(tile.y);
    };
    for (const MotionSpan& span : spans_.all()) {
      const Bounds box = span.bounds();
      tiles_through(grid, box.lo_mm, box.hi_mm).all_of([&](TileIndex tile) {
        return reached[place(tile)] = true;
      });
    }
    const TileRegion whole{{0, 0}, {grid.tiles_x(), grid.tiles_y()}};
    whole.all_of([&](TileIndex tile) {
      if (reached[place(tile)]) all.push_back({grid.axis, tile});
      return true;
    });
  }
  std::ranges::sort(all);
  return all;
}

/// Adds the eras of a tile with motions of a set, and jobs for those that must be carved.
void BlockHistory::add_wanted(FieldTile at, const MotionSet& set, std::vector<Wanted>& wanted,
                              std::vector<GroupJob>& jobs) {
  std::map<std::size_t, std::vector<MotionRun>> runs_of;  // by era
  const Bounds box = tile_bounds(grid(at.axis), at.tile);
  for (const MotionSpan& span : spans_.all()) {
    if (span.run.first > set.last) break;
    if (!span.meets(box)) continue;
    const std::size_t end = eras_.era_of(span.run.last);
    for (std::size_t era = eras_.era_of(span.run.first); era <= end; ++era) {
      const std::uint64_t first = era * eras_.length() + 1;
      runs_of[era].push_back({span.run.stroke, std::max(span.run.first, first),
                              std::min(span.run.last, first + eras_.length() - 1)});
    }
  }
  for (auto& [n, runs] : runs_of) {
    Wanted next{at, &eras_.of(at, n)};
    next.era->used = questions_;
    for (const MotionRun& run : runs) next.last = std::max(next.last, run.last);
    next.is_whole = next.last <= set.last;
    next.without = left_out(runs, set.without);
    const EraTile& kept = *next.era;
    const bool is_right =
        next.is_whole && kept.is_carved && kept.last == next.last && kept.without == next.without;
    if (!is_right) {
      std::erase_if(runs, [&](const MotionRun& run) {
        return run.first > set.last || std::ranges::binary_search(next.without, run.stroke);
      });
      next.job = jobs.size();
      jobs.push_back({.at = at, .last = set.last, .runs = std::move(runs)});
    }
    wanted.push_back(std::move(next));
  }
}

std::expected<std::vector<TileReplacement>, std::string> BlockHistory::carve(
    std::span<const FieldTile> tiles, const MotionSet& set, Workers& workers,
    const std::stop_token& stop) {
  ++questions_;
  std::vector<TileReplacement> carved;
  carved.reserve(tiles.size());
  while (carved.size() < tiles.size()) {
    if (auto ok = carve_some(tiles.subspan(carved.size()), set, workers, stop, carved); !ok) {
      return std::unexpected(ok.error());
    }
  }
  return carved;
}

/// Carves the first of some tiles, as many as the memory for tiles of eras allows, but at least
/// one, and appends them.
std::expected<void, std::string> BlockHistory::carve_some(std::span<const FieldTile> tiles,
                                                          const MotionSet& set, Workers& workers,
                                                          const std::stop_token& stop,
                                                          std::vector<TileReplacement>& carved) {
  std::vector<Wanted> wanted;
  std::vector<GroupJob> jobs;
  std::vector<std::size_t> begins;  // start of each tile in `wanted`
  while (begins.size() < tiles.size() && jobs.size() * sizeof(DexelTile) <= tile_bytes_max_) {
    const FieldTile at = tiles[begins.size()];
    begins.push_back(wanted.size());
    add_wanted(at, set, wanted, jobs);
  }
  const std::size_t count = begins.size();
  begins.push_back(wanted.size());
  if (auto ok = carver_.carve(jobs, motions_, workers, stop); !ok) {
    // Carved tiles are kept for the next query.
    std::erase_if(wanted, [&](const Wanted& next) {
      return next.job != Wanted::kKept && jobs[next.job].tile == nullptr;
    });
    keep(wanted, jobs);
    return std::unexpected(ok.error());
  }
  std::vector<TileReplacement> made(count);
  workers.run(static_cast<int>(count), [&](int number) {
    const auto n = static_cast<std::size_t>(number);
    std::shared_ptr<const DexelTile> first;
    std::shared_ptr<DexelTile> common;  // of the first and later ones
    for (std::size_t w = begins[n]; w < begins[n + 1]; ++w) {
      const Wanted& next = wanted[w];
      const auto& tile = next.job == Wanted::kKept ? next.era->tile : jobs[next.job].tile;
      if (tile && !first) {
        first = tile;
      } else if (tile) {
        if (!common) common = std::make_shared<DexelTile>(*first);
        keep_common(*common, *tile);
      }
    }
    made[n] = {tiles[n], common ? common : first ? first : carver_.start(tiles[n])};
  });
  keep(wanted, jobs);
  std::ranges::move(made, std::back_inserter(carved));
  return {};
}

/// Keeps the tiles of eras that a set has up to their end.
void BlockHistory::keep(std::span<Wanted> wanted, std::span<const GroupJob> jobs) {
  for (Wanted& next : wanted) {
    if (next.job == Wanted::kKept || !next.is_whole) continue;
    *next.era = {true, jobs[next.job].tile, std::move(next.without), next.last, questions_};
  }
  eras_.forget_oldest(tile_bytes_max_);
}

}  // namespace kerf
