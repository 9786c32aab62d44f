// SPDX-License-Identifier: Apache-2.0
#include "server/history/block_history.h"

#include <algorithm>
#include <utility>

#include "kernel/dexel/common_solid.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/motion_reach.h"

namespace kerf {
namespace {

std::size_t bytes_of(const std::shared_ptr<const DexelTile>& tile) {
  return tile ? tile->bytes() : 0;
}

/// Those of the strokes of some runs that a set leaves out; ascending.
std::vector<StrokeId> left_out(std::span<const MotionRun> runs, const StrokeSet& without) {
  std::vector<StrokeId> out;
  for (const MotionRun& run : runs) {
    if (without.contains(run.stroke)) out.push_back(run.stroke);
  }
  std::ranges::sort(out);
  out.erase(std::ranges::unique(out).begin(), out.end());
  return out;
}

}  // namespace

/// A group that contributes to an answer.
struct BlockHistory::Wanted {
  static constexpr std::size_t kKept = SIZE_MAX;
  FieldTile at;
  MotionGroup* group;
  std::size_t job = kKept;  ///< kKept: the tile of the group is the right one
  std::vector<StrokeId> without = {};
};

BlockHistory::BlockHistory(std::filesystem::path journal, const SculptureSettings& settings,
                           const SolidSnapshot& start, HistoryMemory memory)
    : motions_(std::move(journal), memory.windows),
      carver_(settings, start),
      tolerance_mm_(settings.tolerance_mm),
      tile_bytes_max_(memory.tile_bytes) {
  for (const DexelSnapshot& field : start.fields) grids_.push_back(field.grid());
}

void BlockHistory::note(std::uint64_t record, const RecordedMotion& motion) {
  find_reach(*motion.tool, motion.move, grids_, tolerance_mm_, reached_);
  for (const FieldTile at : reached_) logs_[at].add(record, motion.stroke);
}

std::expected<void, std::string> BlockHistory::catch_up(const std::stop_token& stop) {
  return motions_.catch_up(
      [this](std::uint64_t record, const RecordedMotion& motion) { note(record, motion); }, stop);
}

std::expected<std::vector<FieldTile>, std::string> BlockHistory::reach(
    const StrokeSet& strokes, const std::stop_token& stop) {
  std::vector<FieldTile> all;
  for (const StrokeId id : strokes) {
    const Stroke* stroke = this->strokes().find(id);
    if (stroke == nullptr) continue;
    std::vector<FieldTile> of_stroke;
    for (std::uint64_t record = id; record <= stroke->last;) {
      const auto window = motions_.window(record, stop);
      if (!window) return std::unexpected(window.error());
      const std::uint64_t end = (*window)->first + (*window)->motions.size();
      for (; record < end && record <= stroke->last; ++record) {
        const RecordedMotion& motion = (*window)->motions[record - (*window)->first];
        if (motion.tool == nullptr || motion.stroke != id) continue;
        find_reach(*motion.tool, motion.move, grids_, tolerance_mm_, reached_);
        of_stroke.insert(of_stroke.end(), reached_.begin(), reached_.end());
      }
      std::ranges::sort(of_stroke);
      of_stroke.erase(std::ranges::unique(of_stroke).begin(), of_stroke.end());
    }
    all.insert(all.end(), of_stroke.begin(), of_stroke.end());
  }
  std::ranges::sort(all);
  all.erase(std::ranges::unique(all).begin(), all.end());
  return all;
}

std::vector<FieldTile> BlockHistory::tiles() const {
  std::vector<FieldTile> all;
  for (const auto& [at, log] : logs_) all.push_back(at);
  std::ranges::sort(all);
  return all;
}

/// Adds the groups of a tile that hold motions of a set, and jobs for those that must be carved.
void BlockHistory::add_wanted(FieldTile at, TileLog& log, const MotionSet& set,
                              std::vector<Wanted>& wanted, std::vector<GroupJob>& jobs) {
  const auto overlaps = [&](const MotionGroup& group) {
    return std::ranges::any_of(set.without, [&](StrokeId id) {
      const Stroke* stroke = strokes().find(id);
      return stroke != nullptr && id <= group.last && stroke->last >= group.first;
    });
  };
  for (std::size_t n = 0; n < log.groups().size(); ++n) {
    MotionGroup& group = log.groups()[n];
    if (group.first > set.last) break;
    group.used = questions_;
    Wanted& next = wanted.emplace_back(Wanted{at, &group});
    const bool is_whole = group.last <= set.last;
    std::vector<MotionRun> runs;
    if (overlaps(group)) {
      runs = log.runs(n);
      next.without = left_out(runs, set.without);
    }
    if (is_whole && group.is_carved && group.without == next.without) continue;
    if (runs.empty()) runs = log.runs(n);
    std::erase_if(runs, [&](const MotionRun& run) {
      return run.first > set.last || std::ranges::binary_search(next.without, run.stroke);
    });
    next.job = jobs.size();
    jobs.push_back({.at = at, .last = set.last, .runs = std::move(runs)});
  }
}

std::expected<std::vector<TileReplacement>, std::string> BlockHistory::carve(
    std::span<const FieldTile> tiles, const MotionSet& set, Workers& workers,
    const std::stop_token& stop) {
  ++questions_;
  std::vector<Wanted> wanted;
  std::vector<GroupJob> jobs;
  for (const FieldTile at : tiles) {
    if (const auto log = logs_.find(at); log != logs_.end()) {
      add_wanted(at, log->second, set, wanted, jobs);
    }
  }
  if (auto ok = carver_.carve(jobs, motions_, workers, stop); !ok) {
    return std::unexpected(ok.error());
  }
  std::vector<TileReplacement> carved;
  carved.reserve(tiles.size());
  auto next = wanted.begin();
  for (const FieldTile at : tiles) {
    std::shared_ptr<const DexelTile> first;
    std::shared_ptr<DexelTile> common;  // of the first and others
    for (; next != wanted.end() && next->at == at; ++next) {
      const auto& tile = next->job == Wanted::kKept ? next->group->tile : jobs[next->job].tile;
      if (tile && !first) {
        first = tile;
      } else if (tile) {
        if (!common) common = std::make_shared<DexelTile>(*first);
        keep_common(*common, *tile);
      }
    }
    carved.push_back({at, common ? common : first ? first : carver_.start(at)});
  }
  for (Wanted& group : wanted) {
    if (group.job == Wanted::kKept || group.group->last > set.last) continue;
    group.group->tile = jobs[group.job].tile;
    group.group->without = std::move(group.without);
    group.group->is_carved = true;
  }
  forget_oldest();
  return carved;
}

std::size_t BlockHistory::tile_bytes() const {
  std::size_t bytes = 0;
  for (const auto& [at, log] : logs_) {
    for (const MotionGroup& group : log.groups()) bytes += bytes_of(group.tile);
  }
  return bytes;
}

void BlockHistory::forget_oldest() {
  std::size_t bytes = tile_bytes();
  if (bytes <= tile_bytes_max_) return;
  std::vector<MotionGroup*> kept;
  for (auto& [at, log] : logs_) {
    for (MotionGroup& group : log.groups()) {
      if (group.tile) kept.push_back(&group);
    }
  }
  std::ranges::sort(kept, {}, &MotionGroup::used);
  for (MotionGroup* group : kept) {
    if (bytes <= tile_bytes_max_) return;
    bytes -= bytes_of(group->tile);
    group->tile = nullptr;
    group->is_carved = false;
  }
}

std::size_t BlockHistory::log_bytes() const {
  std::size_t bytes = 0;
  for (const auto& [at, log] : logs_) bytes += log.bytes();
  return bytes;
}

}  // namespace kerf
