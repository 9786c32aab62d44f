// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "server/cluster/change_frame.h"
#include "server/cluster/nats_connection.h"
#include "server/platform/clock.h"
#include "server/session/copy_state.h"
#include "server/store/journal_change.h"

namespace kerf {

/// The state of a copy before anything is known.
inline const CopyState kNoCopyYet{0, "the copy is being begun"};

/// Copies the journal of a running session to its stream, on a thread of its own. The journal on
/// the disk is authoritative: unacknowledged changes are read from it again, and at most one change
/// is in memory. Nobody waits for it.
class JournalReplica {
 public:
  struct Source {
    std::string session;
    std::filesystem::path journal;
    std::uint32_t epoch = 1;
    /// Returns the number of commits of the journal so far. Called on the replica's thread.
    std::function<std::uint64_t()> commits = [] { return std::uint64_t{0}; };
  };
  /// `report` is called on the replica's thread when the state of the copy has changed.
  JournalReplica(NatsConnection& nats, Source source, int replicas,
                 std::function<void(const CopyState&)> report);
  /// Ends after the current message.
  ~JournalReplica();
  JournalReplica(const JournalReplica&) = delete;
  JournalReplica& operator=(const JournalReplica&) = delete;

  /// New commits are possible.
  void wake();
  /// Copies everything committed so far, until `end` at most, and then stops for good. Returns
  /// whether all of it was copied.
  bool finish(Clock::time_point end);

 private:
  void run(const std::stop_token& stop);
  /// Sends new commits. Returns false on failure; try again later.
  bool copy(const std::stop_token& stop);
  /// Reads the end of the stream, and whether this journal continues it.
  bool begin();
  /// Decides how to continue a stream that ends with `last`.
  bool continue_after(const Frame& last);
  bool send();
  bool fail(const std::string& reason);
  /// Like fail(), for conditions that do not pass by themselves.
  bool refuse(const std::string& reason);
  void show();

  NatsConnection& nats_;
  Source source_;
  int replicas_;
  std::function<void(const CopyState&)> report_;

  // ---- thread only ----
  JournalChanges changes_;
  std::uint64_t writer_;
  bool has_begun_ = false, is_conflict_ = false;
  std::uint64_t last_message_ = 0;       ///< number of the stream's last message
  std::optional<JournalChange> change_;  ///< being sent
  std::uint64_t change_number_ = 0;
  std::optional<std::uint64_t> change_commits_;  ///< CopyState::commits once it is sent
  std::uint32_t next_part_ = 0;
  CopyState state_ = kNoCopyYet, shown_ = kNoCopyYet;

  std::mutex mutex_;
  std::condition_variable_any wake_;
  bool woken_ = true, finishing_ = false, finished_ = false;
  std::jthread thread_;
};

}  // namespace kerf
