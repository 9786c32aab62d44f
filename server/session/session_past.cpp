// SPDX-License-Identifier: Apache-2.0
// The part of Session that looks back.
#include <algorithm>
#include <utility>

#include "server/history/block_history.h"
#include "server/session/session.h"

namespace kerf {
namespace {

/// Number of records before a span of forces that are carved for the force pending in its first
/// motions: at most this many for a stroke that reaches into the span, and for other strokes.
constexpr std::uint64_t kFeltBeforeMax = 20'000;
constexpr std::uint64_t kFeltBefore = 256;

/// Returns the record at which carving must begin to get the forces of all motions from `first` on.
std::uint64_t felt_from(const StrokeTable& strokes, std::uint64_t first,
                        std::optional<ParticipantId> only) {
  const auto before = [&](std::uint64_t records) { return first > records ? first - records : 1; };
  std::uint64_t from = before(kFeltBefore);
  for (const Stroke& stroke : strokes.all()) {
    const bool goes_on = stroke.id < first && stroke.last >= first;
    if (goes_on && (!only || *only == stroke.participant)) from = std::min(from, stroke.id);
  }
  return std::max(from, before(kFeltBeforeMax));
}

/// Adds the tiles that were cut before the first record, as in a salvaged journal. Sorted.
std::vector<FieldTile> shown_tiles(const SolidSnapshot& start, std::vector<FieldTile> tiles) {
  const std::size_t reached = tiles.size();
  for (const DexelSnapshot& field : start.fields) {
    field.for_each_touched(
        [&](TileIndex at, const DexelTile&) { tiles.push_back({field.grid().axis, at}); });
  }
  if (tiles.size() == reached) return tiles;
  std::ranges::sort(tiles);
  const auto twice = std::ranges::unique(tiles);
  tiles.erase(twice.begin(), twice.end());
  return tiles;
}

}  // namespace

/// Carves all tiles with the motions that `choose` returns once the journal has been read; nullopt
/// if it returns none. Yields its turn to requests about strokes and continues after them.
std::expected<std::optional<std::vector<TileReplacement>>, std::string> Session::look_back(
    const std::function<std::optional<MotionSet>()>& choose, Workers& workers,
    const std::stop_token& stop) {
  using Tiles = std::expected<std::optional<std::vector<TileReplacement>>, std::string>;
  const auto look = [&](const std::stop_token& end) -> Tiles {
    if (auto read = read_history(end); !read) return std::unexpected(read.error());
    const std::optional<MotionSet> set = choose();
    if (!set) return std::nullopt;
    return history_->carve(shown_tiles(start_, history_->tiles()), *set, workers, end);
  };
  for (;;) {
    std::stop_source end;
    const std::stop_callback by_caller(stop, [&] { end.request_stop(); });
    const auto lock = history_turns_.look_back(kHistoryPatience, end);
    if (!lock) return std::unexpected(kOthersAskHistory);
    auto tiles = look(end.get_token());
    const bool is_interrupted = end.stop_requested() && !stop.stop_requested();
    if (tiles || !is_interrupted) return tiles;
  }
}

std::expected<std::optional<std::vector<TileReplacement>>, std::string> Session::tiles_at(
    std::uint64_t record, Workers& workers, const std::stop_token& stop) {
  const auto then = [&]() -> std::optional<MotionSet> {
    if (record > history_->last() || record < base_) return std::nullopt;
    return history_->strokes().at(record);
  };
  return look_back(then, workers, stop);
}

std::expected<SolidSnapshot, std::string> Session::solid_of(
    std::span<const TileReplacement> tiles) const {
  auto block = Sculpture::create(sculpture_.settings());
  if (!block) return std::unexpected(block.error().reason);
  SculptureState untouched;
  untouched.solid = start_;
  if (!block->restore(untouched)) return std::unexpected("the block is of another size");
  block->replace(tiles);
  return block->solid();
}

std::expected<std::optional<SolidSnapshot>, std::string> Session::solid_at(
    std::uint64_t record, Workers& workers, const std::stop_token& stop) {
  const auto tiles = tiles_at(record, workers, stop);
  if (!tiles) return std::unexpected(tiles.error());
  if (!*tiles) return std::nullopt;
  return solid_of(**tiles);
}

std::expected<FeltStart, std::string> Session::felt_start(std::uint64_t first,
                                                          std::optional<ParticipantId> only,
                                                          Workers& workers,
                                                          const std::stop_token& stop) {
  FeltStart start;
  const auto before = [&]() -> std::optional<MotionSet> {
    const StrokeTable& strokes = history_->strokes();
    start.undone = strokes.at(history_->last()).without;
    start.last = felt_from(strokes, std::min(first, history_->last() + 1), only) - 1;
    return MotionSet{start.last, start.undone};
  };
  const auto tiles = look_back(before, workers, stop);
  if (!tiles) return std::unexpected(tiles.error());
  auto solid = solid_of(**tiles);
  if (!solid) return std::unexpected(solid.error());
  start.solid = *std::move(solid);
  return start;
}

}  // namespace kerf
