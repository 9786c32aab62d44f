// SPDX-License-Identifier: Apache-2.0
#include "server/session/session_past.h"

#include <algorithm>
#include <exception>
#include <new>
#include <utility>

#include "kernel/sculpture_state.h"
#include "server/history/block_history.h"
#include "server/history/journal_records.h"

namespace kerf {
namespace {

/// Number of records after which the journal is read ahead: a bound for the reading of an undo.
constexpr std::uint64_t kReadAhead = 20'000;

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

SessionPast::SessionPast(const SculptureSettings& settings, SolidSnapshot start, std::uint64_t base,
                         SessionJournal& journal, Executor& executor, SessionOwner owner)
    : settings_(settings),
      start_(std::move(start)),
      base_(base),
      journal_(journal),
      executor_(executor),
      owner_(std::move(owner)) {}

SessionPast::~SessionPast() = default;

SessionPast::Turn::Turn(SessionPast& past, HistoryTurns::Lock lock)
    : past_(past), lock_(std::move(lock)), exceptions_(std::uncaught_exceptions()) {}

SessionPast::Turn::~Turn() {
  if (lock_.owns_lock() && std::uncaught_exceptions() > exceptions_) past_.discard();
}

void SessionPast::discard() { history_.reset(); }

std::optional<JournalError> SessionPast::damage_after(const std::string& reason,
                                                      const std::stop_token& stop) const {
  if (reason == kOthersAskHistory || journal_.pause() || stop.stop_requested()) return std::nullopt;
  return journal_.health().find_damage(journal_.file(), stop);
}

std::expected<BlockHistory*, std::string> SessionPast::read(const std::stop_token& stop) {
  if (auto flushed = journal_.flush(); !flushed) return std::unexpected(describe(flushed.error()));
  if (!history_) {
    history_ = std::make_unique<BlockHistory>(journal_records(journal_.file()), settings_, start_);
  }
  if (auto ok = history_->catch_up(stop); !ok) return std::unexpected(ok.error());
  return history_.get();
}

void SessionPast::read_ahead() {
  if (background_ == nullptr || closed_ || reads_ahead_) return;
  if (journal_.sequence() < read_ + kReadAhead) return;
  reads_ahead_ = true;
  read_ = journal_.sequence();
  background_->post([this, session = owner_.hold()] {
    try {
      const Turn turn(*this, turns_.try_now());
      if (turn) (void)read({});  // An undo reports the error later.
    } catch (const std::bad_alloc&) {
      // The next undo reads the journal.
    }
    executor_.post([this, session] { reads_ahead_ = false; });
  });
}

void SessionPast::forget() {
  read_ = 0;
  const auto lock = turns_.try_now();
  if (lock) discard();
}

/// Carves all tiles with the motions that `choose` returns once the journal has been read; nullopt
/// if it returns none. Yields its turn to requests about strokes and continues after them.
SessionPast::Tiles SessionPast::look_back(const Choose& choose, Workers& workers,
                                          const std::stop_token& stop) {
  const auto look = [&](const std::stop_token& end) -> Tiles {
    const auto history = read(end);
    if (!history) return std::unexpected(history.error());
    const std::optional<MotionSet> set = choose(**history);
    if (!set) return std::nullopt;
    return (*history)->carve(shown_tiles(start_, (*history)->tiles()), *set, workers, end);
  };
  for (;;) {
    std::stop_source end;
    const std::stop_callback by_caller(stop, [&] { end.request_stop(); });
    const Turn turn(*this, turns_.look_back(kHistoryPatience, end));
    if (!turn) return std::unexpected(kOthersAskHistory);
    auto tiles = look(end.get_token());
    const bool is_interrupted = end.stop_requested() && !stop.stop_requested();
    if (tiles || !is_interrupted) return tiles;
  }
}

std::expected<std::optional<std::vector<TileReplacement>>, std::string> SessionPast::tiles_at(
    std::uint64_t record, Workers& workers, const std::stop_token& stop) {
  const auto then = [&](const BlockHistory& history) -> std::optional<MotionSet> {
    if (record > history.last() || record < base_) return std::nullopt;
    return history.strokes().at(record);
  };
  return look_back(then, workers, stop);
}

std::expected<SolidSnapshot, std::string> SessionPast::solid_of(
    std::span<const TileReplacement> tiles) const {
  auto block = Sculpture::create(settings_);
  if (!block) return std::unexpected(block.error().reason);
  SculptureState untouched;
  untouched.solid = start_;
  if (!block->restore(untouched)) return std::unexpected("the block is of another size");
  block->replace(tiles);
  return block->solid();
}

std::expected<std::optional<SolidSnapshot>, std::string> SessionPast::solid_at(
    std::uint64_t record, Workers& workers, const std::stop_token& stop) {
  const auto tiles = tiles_at(record, workers, stop);
  if (!tiles) return std::unexpected(tiles.error());
  if (!*tiles) return std::nullopt;
  return solid_of(**tiles);
}

std::expected<FeltStart, std::string> SessionPast::felt_start(std::uint64_t first,
                                                              std::optional<ParticipantId> only,
                                                              Workers& workers,
                                                              const std::stop_token& stop) {
  FeltStart start;
  const auto before = [&](const BlockHistory& history) -> std::optional<MotionSet> {
    const StrokeTable& strokes = history.strokes();
    start.undone = strokes.at(history.last()).without;
    start.last = felt_from(strokes, std::min(first, history.last() + 1), only) - 1;
    return MotionSet{start.last, start.undone};
  };
  const auto tiles = look_back(before, workers, stop);
  if (!tiles) return std::unexpected(tiles.error());
  auto solid = solid_of(**tiles);
  if (!solid) return std::unexpected(solid.error());
  start.solid = *std::move(solid);
  return start;
}

std::expected<std::vector<ListedStroke>, std::string> SessionPast::strokes(
    std::uint64_t since, const std::stop_token& stop) {
  const Turn turn = ask();
  if (!turn) return std::unexpected(kOthersAskHistory);
  const auto history = read(stop);
  if (!history) return std::unexpected(history.error());
  const StrokeTable& table = (*history)->strokes();
  const StrokeSet undone = table.at((*history)->last()).without;
  std::vector<ListedStroke> list;
  for (const Stroke& stroke : table.all()) {
    if (stroke.last >= since) list.push_back({stroke, undone.contains(stroke.id)});
  }
  return list;
}

std::expected<std::optional<SurfaceMaker>, std::string> SessionPast::first_to_remove(
    const StockCell& cell, std::uint64_t record, const std::stop_token& stop) {
  const Turn turn = ask();
  if (!turn) return std::unexpected(kOthersAskHistory);
  const auto history = read(stop);
  if (!history) return std::unexpected(history.error());
  return (*history)->first_to_remove(cell, (*history)->strokes().at(record), stop);
}

std::expected<std::vector<ParticipantId>, std::string> SessionPast::owners(
    std::span<const StockCell> cells, std::uint64_t record, const std::stop_token& stop) {
  const Turn turn = ask();
  if (!turn) return std::unexpected(kOthersAskHistory);
  const auto history = read(stop);
  if (!history) return std::unexpected(history.error());
  return (*history)->owners(cells, (*history)->strokes().at(record), stop);
}

}  // namespace kerf
