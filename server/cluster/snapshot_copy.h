// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "server/cluster/nats_connection.h"

namespace kerf {

/// The stream and the subject of the snapshots of a session's block.
std::string snapshot_stream(const std::string& session);
std::string snapshot_subject(const std::string& session);

/// Copies the snapshots of the block of one session to its stream, which keeps the newest two: with
/// one of them a takeover replays only the records after it. One thread uses it.
class SnapshotCopy {
 public:
  struct Source {
    std::string session;
    std::filesystem::path journal;
    std::uint32_t epoch = 1;
  };
  SnapshotCopy(NatsConnection& nats, Source source, int replicas);

  /// Stores the snapshot that is beside the journal, unless it has been stored, or holds records
  /// after `copied`, the last one of which NATS has a copy. Returns whether it has stored one.
  /// Waits for each message; ends early, with false, when a stop is requested. The error is one
  /// sentence: NATS is away, or a server of a later epoch has the session.
  std::expected<bool, std::string> copy(std::uint64_t copied, const std::stop_token& stop);
  /// The last record of the newest snapshot of the stream; 0: there is none.
  std::uint64_t record() const { return record_; }

 private:
  std::expected<void, std::string> begin();
  std::expected<bool, std::string> store(std::uint64_t record, const std::stop_token& stop);

  NatsConnection& nats_;
  Source source_;
  int replicas_;
  std::uint64_t writer_;
  bool has_begun_ = false;
  std::uint64_t last_message_ = 0;  ///< number of the stream's last one
  std::uint64_t record_ = 0;
  std::uint64_t kept_from_ =
      0;                      ///< first message of the newest complete snapshot; 0: none is known
  std::uint64_t number_ = 0;  ///< of the last snapshot that was begun
  /// When the file was written that needs nothing more.
  std::optional<std::filesystem::file_time_type> done_;
};

/// Greater than any epoch.
inline constexpr std::uint32_t kAnyEpoch = 0xFFFF'FFFF;

/// Puts the snapshots of a session's stream beside its journal, the newest and the one before it,
/// if they are newer than what is there. Whether they are right is verified when they are used
/// (restore()). Returns the last record of the newest one that is beside the journal then; 0: there
/// is none. The error, one sentence, costs time only: all records are replayed. `epoch`: of who
/// asks; the stream must be of an earlier one.
std::expected<std::uint64_t, std::string> fetch_snapshots(NatsConnection& nats,
                                                          const std::string& session,
                                                          std::uint32_t epoch,
                                                          const std::filesystem::path& journal);

}  // namespace kerf
