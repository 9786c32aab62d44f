// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "kernel/sculpture.h"
#include "kernel/sculpture_state.h"
#include "server/session/carving.h"
#include "server/session/replay.h"
#include "server/session/session_journal.h"
#include "server/session/session_owner.h"
#include "server/session/snapshot_schedule.h"
#include "server/threads/executor.h"

namespace kerf {

/// Writes snapshots of a session's block next to its journal.
class SnapshotKeeper {
 public:
  /// The parts of the session that it works with.
  struct Parts {
    const std::string& id;
    Executor& executor;
    Sculpture& sculpture;
    SessionJournal& journal;
    const Carving& carving;
  };
  /// The references in `parts` must outlive this. `newest`: the newest snapshot usable for a
  /// restart. `is_between_records`: see Session; called on the executor.
  SnapshotKeeper(const Parts& parts, const SnapshotSchedule& schedule, UsedSnapshot newest,
                 SessionOwner owner, std::function<bool()> is_between_records);

  // ---- any thread ----
  /// Commits and closes the journal. With `with_snapshot`, first writes a last snapshot if that
  /// saves time at the next start. Call once, after close(). Afterwards no snapshot is written.
  std::expected<void, JournalError> finish_journal(bool with_snapshot);
  /// While the disk is low, no further snapshot is begun.
  void note_disk(bool is_low) { disk_is_low_.store(is_low, std::memory_order_relaxed); }

  /// Writes snapshots periodically from now on. Call once, when the session has been created.
  void keep(SnapshotOptions options);

  // ---- executor only ----
  void write_if_due();
  /// The session is closed: nothing is applied afterwards.
  void close();

 private:
  using Outcome = std::expected<void, std::string>;
  Outcome write(std::uint64_t at, const SculptureState& state);
  Outcome write_locked(std::uint64_t at, const SculptureState& state);

  const std::string& id_;
  Executor& executor_;
  Sculpture& sculpture_;
  SessionJournal& journal_;
  const Carving& carving_;
  SessionOwner owner_;
  std::function<bool()> is_between_records_;
  SnapshotOptions options_;
  SnapshotSchedule schedule_;
  bool closed_ = false;
  std::unique_ptr<SculptureState> last_state_;  ///< of a closed session
  std::mutex mutex_;                            ///< held during a write; guards the next
  bool has_ended_ = false, has_failed_ = false;
  UsedSnapshot good_;  ///< newest snapshot usable for a restart
  std::atomic<bool> disk_is_low_ = false;
};

}  // namespace kerf
