// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "kernel/sculpture.h"
#include "server/history/surface_maker.h"
#include "server/session/felt_start.h"
#include "server/session/history_turns.h"
#include "server/session/session_journal.h"
#include "server/session/session_owner.h"
#include "server/session/stroke_request.h"
#include "server/threads/executor.h"

namespace kerf {

class BlockHistory;
class Workers;

/// The history of a session's block, which one user at a time reads from the journal. Errors are
/// one sentence.
class SessionPast {
 public:
  /// A turn with the history. If an exception ends it, for lack of memory say, the history may be
  /// incomplete: it is discarded, and read again by the next user.
  class Turn {
   public:
    Turn(SessionPast& past, HistoryTurns::Lock lock);
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    ~Turn();
    /// Whether the turn was granted.
    explicit operator bool() const { return lock_.owns_lock(); }

   private:
    SessionPast& past_;
    HistoryTurns::Lock lock_;
    int exceptions_;  ///< in flight when it began
  };

  /// `start`: the block before the first record. `base`: see base(). `settings`, `journal` and
  /// `executor`, which is that of the session, must outlive this.
  SessionPast(const SculptureSettings& settings, SolidSnapshot start, std::uint64_t base,
              SessionJournal& journal, Executor& executor, SessionOwner owner);
  ~SessionPast();
  SessionPast(const SessionPast&) = delete;
  SessionPast& operator=(const SessionPast&) = delete;

  // ---- any thread ----
  /// The first record after which the block is known (Replayed::base).
  std::uint64_t base() const { return base_; }
  /// Returns the damage of the journal that made a question about the history fail with `reason`.
  /// Nullopt if the failure is temporary (history in use, failing disk, `stop` requested): retry.
  /// May read the journal and block: do not call on the executor.
  std::optional<JournalError> damage_after(const std::string& reason,
                                           const std::stop_token& stop) const;

  // The next ones block: do not call on the executor.
  /// Returns the solid as of a record, without the strokes that were undone then. Nullopt if there
  /// is no such record yet.
  std::expected<std::optional<SolidSnapshot>, std::string> solid_at(
      std::uint64_t record, Workers& workers, const std::stop_token& stop = {});
  /// Returns all tiles that motions have reached, as of a record. Nullopt as for solid_at(). Yields
  /// to requests about strokes that come meanwhile, then continues.
  std::expected<std::optional<std::vector<TileReplacement>>, std::string> tiles_at(
      std::uint64_t record, Workers& workers, const std::stop_token& stop = {});
  /// Returns the start for carving the forces of the records from `first` on (export_force_plot).
  std::expected<FeltStart, std::string> felt_start(std::uint64_t first,
                                                   std::optional<ParticipantId> only,
                                                   Workers& workers,
                                                   const std::stop_token& stop = {});
  /// Returns the strokes whose last record is `since` or later.
  std::expected<std::vector<ListedStroke>, std::string> strokes(std::uint64_t since,
                                                                const std::stop_token& stop = {});
  /// Queries BlockHistory about the motions that make up the block after a record.
  std::expected<std::optional<SurfaceMaker>, std::string> first_to_remove(
      const StockCell& cell, std::uint64_t record, const std::stop_token& stop = {});
  std::expected<std::vector<ParticipantId>, std::string> owners(std::span<const StockCell> cells,
                                                                std::uint64_t record,
                                                                const std::stop_token& stop = {});
  /// Waits at most kHistoryPatience for a turn with the history, as a request about strokes.
  Turn ask() { return Turn(*this, turns_.ask(kHistoryPatience)); }
  /// Reads the committed records, including all journaled before the call, and returns the history,
  /// never null, for as long as the turn of the caller lasts.
  std::expected<BlockHistory*, std::string> read(const std::stop_token& stop);
  /// Discards the history after an exception that the caller has caught within its turn.
  void discard();

  // ---- executor only ----
  /// Reads the journal ahead on this background thread from now on; it must outlive this. Call
  /// once, when the session has been created.
  void read_ahead_on(Executor& background) { background_ = &background; }
  /// Reads the journal on the background thread if it has grown enough.
  void read_ahead();
  /// Frees the memory of the history unless it is in use.
  void forget();
  /// Ends reading ahead.
  void close() { closed_ = true; }

 private:
  using Tiles = std::expected<std::optional<std::vector<TileReplacement>>, std::string>;
  using Choose = std::function<std::optional<MotionSet>(const BlockHistory&)>;
  Tiles look_back(const Choose& choose, Workers& workers, const std::stop_token& stop);
  std::expected<SolidSnapshot, std::string> solid_of(std::span<const TileReplacement> tiles) const;

  const SculptureSettings& settings_;
  SolidSnapshot start_;
  std::uint64_t base_;
  SessionJournal& journal_;
  Executor& executor_;
  SessionOwner owner_;
  Executor* background_ = nullptr;         ///< null: never reads ahead
  HistoryTurns turns_;                     ///< whose turn it is to use the next one
  std::unique_ptr<BlockHistory> history_;  ///< created on first use
  std::uint64_t read_ = 0;                 ///< record up to which it was read ahead
  bool reads_ahead_ = false;
  bool closed_ = false;
};

}  // namespace kerf
