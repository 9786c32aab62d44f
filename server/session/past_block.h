// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <expected>
#include <limits>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "kernel/sculpture.h"
#include "server/session/past_source.h"
#include "server/wire/types.h"

namespace kerf {

/// How far a block of the past plays: until the first of these is reached.
struct PlayUntil {
  std::int64_t ms = std::numeric_limits<std::int64_t>::max();  ///< since 1970, UTC
  std::uint64_t record = std::numeric_limits<std::uint64_t>::max();
  bool feels = true;  ///< compute the forces of the motions

  bool covers(const JournalRecord& next) const {
    return next.wall_ms <= ms && next.sequence <= record;
  }
};

/// A copy of a journal's block that seeks to any record and plays forward from there, with the
/// forces of the participants. If an exception ends a call, for lack of memory say, the next call
/// begins with a new block. Not thread-safe. Errors are one sentence.
class PastBlock {
 public:
  /// The block before the first record.
  static std::expected<PastBlock, std::string> create(std::unique_ptr<PastSource> source);

  /// Moves the block to the state after a record, without the strokes that were undone then.
  /// Returns false and changes nothing if there is no such record yet.
  std::expected<bool, std::string> seek(std::uint64_t record, const std::stop_token& stop);

  /// Where playing has ended.
  struct Played {
    bool is_late = false;  ///< `budget` was used up before the end was reached
    /// When the next record was appended; 0 if there is none yet.
    std::int64_t next_ms = 0;
  };
  /// Applies the next records, for about `budget`.
  std::expected<Played, std::string> play(const PlayUntil& until, std::chrono::microseconds budget,
                                          const std::stop_token& stop);

  /// Number of the last record that the block holds.
  std::uint64_t record() const { return record_; }
  /// When it was appended; 0: unknown.
  std::int64_t time_ms() const { return time_ms_; }
  double removed_mm3() const { return block_.removed_volume_mm3(); }
  SolidSnapshot solid() { return block_.solid(); }
  const Sculpture& block() const { return block_; }
  /// Returns the surface tiles changed since the last call, with duplicates.
  std::vector<TileIndex> take_changed();
  /// The tools that moved since seek(), with the force of their last motion.
  const wire::ToolStates& tools() const { return tools_; }

 private:
  PastBlock(std::unique_ptr<PastSource> source, Sculpture block);
  using Tiles = std::expected<std::optional<std::vector<TileReplacement>>, std::string>;
  std::expected<bool, std::string> take(std::uint64_t record, const Tiles& tiles);
  std::expected<void, std::string> replace(std::span<const TileReplacement> tiles);
  std::expected<void, std::string> change(const JournalRecord& record, const PlayUntil& until,
                                          const std::stop_token& stop);
  std::expected<void, std::string> read_ahead(const std::stop_token& stop);
  std::expected<void, std::string> apply(const JournalRecord& record, const PlayUntil& until,
                                         const std::stop_token& stop);
  void show(const JournalRecord& record, const MoveTool& move, const MotionResult& result);

  std::unique_ptr<PastSource> source_;
  Sculpture block_;
  std::uint64_t record_ = 0;
  std::int64_t time_ms_ = 0;
  bool is_torn_ = false;             ///< the block matches no record
  std::deque<JournalRecord> ahead_;  ///< read but not applied
  std::vector<TileIndex> changed_;
  wire::ToolStates tools_;
};

}  // namespace kerf
