// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <expected>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "kernel/sculpture.h"
#include "server/store/journal_record.h"
#include "server/wire/types.h"

namespace kerf {

class Session;

/// A copy of the block of a session that goes to any of its records, and forward from there with
/// the forces of its participants. Reads the journal and asks the session's history; it belongs on
/// a thread that serves nobody, and never waits for the session's thread. Not thread-safe. Errors
/// are one sentence.
class PastBlock {
 public:
  /// The block before the first record.
  static std::expected<PastBlock, std::string> create(std::shared_ptr<Session> session);

  /// Makes the block the one after a record, without the strokes that were undone then; false,
  /// without a change, if there is no such record yet.
  std::expected<bool, std::string> seek(std::uint64_t record, const std::stop_token& stop);

  /// Where playing has ended.
  struct Played {
    bool is_late = false;  ///< `budget` was used up before `until_ms` was reached
    /// When the next record was appended; 0: there is none yet.
    std::int64_t next_ms = 0;
  };
  /// Applies the records that were appended until a time (ms since 1970, UTC), for about `budget`.
  std::expected<Played, std::string> play(std::int64_t until_ms, std::chrono::microseconds budget,
                                          const std::stop_token& stop);

  /// Number of the last record that the block holds.
  std::uint64_t record() const { return record_; }
  /// When it was appended; 0: unknown.
  std::int64_t time_ms() const { return time_ms_; }
  double removed_mm3() const { return block_.removed_volume_mm3(); }
  SolidSnapshot solid() { return block_.solid(); }
  /// The tiles of the surface that have changed since the last call; with duplicates.
  std::vector<TileIndex> take_changed();
  /// The tools that have moved since seek(), with the force of their last motion.
  const wire::ToolStates& tools() const { return tools_; }

 private:
  PastBlock(std::shared_ptr<Session> session, Sculpture block);
  std::expected<void, std::string> read_ahead(const std::stop_token& stop);
  std::expected<void, std::string> apply(const JournalRecord& record, std::int64_t until_ms,
                                         const std::stop_token& stop);
  void show(const JournalRecord& record, const MoveTool& move, const MotionResult& result);

  std::shared_ptr<Session> session_;
  Sculpture block_;
  std::uint64_t record_ = 0;
  std::int64_t time_ms_ = 0;
  std::deque<JournalRecord> ahead_;  ///< read, and not applied yet
  std::vector<TileIndex> changed_;
  wire::ToolStates tools_;
};

}  // namespace kerf
