// SPDX-License-Identifier: Apache-2.0
// The part of BlockHistory that finds the makers of many points of the surface. All points are cut
// at once, in tiles that hold only their quanta, by the motions in the order of the journal. The
// rest is only checked when another participant continues in a tile, so a participant who carved
// alone costs one check.
#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "kernel/dexel/dexel_tile.h"
#include "kernel/motion_reach.h"
#include "kernel/tile_carver.h"
#include "server/history/block_history.h"

namespace kerf {
namespace {

/// Windows read before they are cut: 10 MB.
constexpr std::size_t kOwnerWindowsAtOnce = 64;

FieldTile tile_of(const StockCell& cell) {
  return {cell.axis, {cell.i / kTileSide, cell.j / kTileSide}};
}
int column_of(const StockCell& cell) { return cell.j % kTileSide * kTileSide + cell.i % kTileSide; }
auto order_of(const StockCell& cell) {
  return std::tuple(tile_of(cell), column_of(cell), cell.depth);
}

/// Whether a tile contains a quantum.
bool holds(const DexelTile& tile, const StockCell& cell) {
  const auto has = [&](const Dexel& dexel) {
    return dexel.bottom <= cell.depth && cell.depth < dexel.top;
  };
  const ColumnView column = tile.view(column_of(cell));
  return has(column.topmost) || std::ranges::any_of(column.lower, has);
}

/// The remaining quanta of one tile, and the current cutter.
struct OpenTile {
  FieldTile at;
  Bounds box;                      ///< around the rays of its quanta
  std::vector<std::size_t> cells;  ///< indices into the list of all of them, sorted by order_of()
  ParticipantId cutter = 0;        ///< has cut since the last check; 0: nobody
};

class OwnerSearch {
 public:
  OwnerSearch(std::span<const StockCell> cells, TileCarver& carver)
      : cells_(cells), carver_(carver), owners_(cells.size(), 0) {}

  /// Adds a quantum that was stock, with a box around its ray; sorted by order_of().
  void add(std::size_t n, const Bounds& box) {
    const FieldTile at = tile_of(cells_[n]);
    if (tiles_.empty() || tiles_.back().at != at) tiles_.push_back({at, box, {}});
    tiles_.back().box = joined(tiles_.back().box, box);
    tiles_.back().cells.push_back(n);
  }
  /// Call it after the last add().
  void begin() {
    for (const OpenTile& tile : tiles_) carver_.begin(tile.at, made_of(tile));
  }

  /// Adds the motions of a span up to a record; spans in the order of their first records.
  void add(const MotionSpan& span, ParticipantId by, std::uint64_t last) {
    Run run{span.run.stroke, by, span.run.first, std::min(span.run.last, last), {}};
    for (std::size_t n = 0; n < tiles_.size(); ++n) {
      if (span.meets(tiles_[n].box)) run.tiles.push_back(n);
    }
    if (!run.tiles.empty()) runs_.push_back(std::move(run));
  }

  /// Returns the first records of the windows of these motions; ascending.
  std::vector<std::uint64_t> windows() const {
    std::vector<std::uint64_t> firsts;
    for (const Run& run : runs_) {
      for (auto first = RecordedMotions::window_begin(run.first); first <= run.last;
           first += RecordedMotions::kWindow) {
        firsts.push_back(first);
      }
    }
    std::ranges::sort(firsts);
    firsts.erase(std::ranges::unique(firsts).begin(), firsts.end());
    return firsts;
  }

  /// Cuts the motions of a window. All windows come, in ascending order.
  void cut(const RecordedMotions::Window& window) {
    const std::uint64_t end = window.first + window.motions.size();
    for (; next_ < runs_.size() && runs_[next_].first < end; ++next_) now_.push_back(next_);
    touches_.clear();
    for (const std::size_t n : now_) {
      const Run& run = runs_[n];
      for (auto record = std::max(run.first, window.first); record < std::min(run.last + 1, end);
           ++record) {
        const RecordedMotion& motion = window.motions[record - window.first];
        if (motion.tool != nullptr && motion.stroke == run.stroke) touches_.push_back({record, n});
      }
    }
    std::erase_if(now_, [&](std::size_t n) { return runs_[n].last < end; });
    std::ranges::sort(touches_);
    for (const auto& [record, n] : touches_) cut(window.motions[record - window.first], runs_[n]);
  }

  /// Returns the participant who removed each quantum.
  std::vector<ParticipantId> take() {
    for (OpenTile& tile : tiles_) look(tile);
    return std::move(owners_);
  }

 private:
  struct Run {
    StrokeId stroke;
    ParticipantId by;
    std::uint64_t first, last;
    std::vector<std::size_t> tiles;  ///< that it may reach
  };

  std::shared_ptr<const DexelTile> made_of(const OpenTile& open) const {
    auto tile = std::make_shared<DexelTile>();
    tile->bottom.fill(0);
    tile->top.fill(0);
    std::vector<Dexel> column;
    for (auto n = open.cells.begin(); n != open.cells.end();) {
      const int at = column_of(cells_[*n]);
      column.clear();
      for (; n != open.cells.end() && column_of(cells_[*n]) == at; ++n) {
        const std::int32_t depth = cells_[*n].depth;
        if (!column.empty() && depth <= column.back().top) {
          column.back().top = depth + 1;
        } else {
          column.push_back({depth, depth + 1});
        }
      }
      tile->write(at, column);
    }
    tile->update_bounds();
    return tile;
  }

  void cut(const RecordedMotion& motion, const Run& run) {
    reached_.clear();
    for (const std::size_t n : run.tiles) {
      OpenTile& tile = tiles_[n];
      if (tile.cells.empty() || !may_meet(*motion.tool, motion.motion, tile.box)) continue;
      if (tile.cutter != run.by) look(tile);
      tile.cutter = run.by;
      reached_.push_back(tile.at);
    }
    if (!reached_.empty()) carver_.cut(*motion.tool, motion.motion, reached_);
  }

  /// Attributes the missing quanta to the cutter.
  void look(OpenTile& tile) {
    if (tile.cutter == 0) return;
    const DexelTile& left = *carver_.find(tile.at);
    std::erase_if(tile.cells, [&](std::size_t n) {
      if (holds(left, cells_[n])) return false;
      owners_[n] = tile.cutter;
      return true;
    });
    tile.cutter = 0;
  }

  std::span<const StockCell> cells_;
  TileCarver& carver_;
  std::vector<ParticipantId> owners_;
  std::vector<OpenTile> tiles_;  ///< sorted
  std::vector<Run> runs_;
  std::size_t next_ = 0;          ///< in runs_
  std::vector<std::size_t> now_;  ///< runs that have begun and not ended
  std::vector<std::pair<std::uint64_t, std::size_t>> touches_;  ///< record and run
  std::vector<FieldTile> reached_;
};

}  // namespace

std::expected<std::vector<ParticipantId>, std::string> BlockHistory::owners(
    std::span<const StockCell> cells, const MotionSet& set, const std::stop_token& stop) {
  TileCarver carver(shape_settings_, start_);
  OwnerSearch search(cells, carver);
  std::vector<std::size_t> order(cells.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t n) { return order_of(cells[n]); });
  for (const std::size_t n : order) {
    if (!was_stock(start_, cells[n])) continue;
    search.add(n, box_of(cells[n], grid(cells[n].axis), margin_mm_));
  }
  search.begin();
  const std::uint64_t last_record = std::min(set.last, last());
  for (const MotionSpan& span : spans_.all()) {
    if (span.run.first > last_record) break;
    const Stroke* stroke = strokes().find(span.run.stroke);
    if (stroke == nullptr || set.without.contains(stroke->id)) continue;
    search.add(span, stroke->participant, last_record);
  }
  const std::vector<std::uint64_t> firsts = search.windows();
  for (std::span left(firsts); !left.empty();) {
    const auto now = left.first(std::min(kOwnerWindowsAtOnce, left.size()));
    left = left.subspan(now.size());
    const auto windows = motions_.windows(now, stop);
    if (!windows) return std::unexpected(windows.error());
    for (const auto& window : *windows) {
      if (stop.stop_requested()) return std::unexpected("stopped");
      search.cut(*window);
    }
  }
  return search.take();
}

}  // namespace kerf
