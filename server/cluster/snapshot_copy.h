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

/// Copies the snapshots of one session's block to its stream, which keeps the newest two. With one
/// of them a takeover replays only the later records. For one thread.
class SnapshotCopy {
 public:
  struct Source {
    std::string session;
    std::filesystem::path journal;
    std::uint32_t epoch = 1;
  };
  SnapshotCopy(NatsConnection& nats, Source source, int replicas);

  /// Stores the journal's newest snapshot, unless it has been stored or has records after `copied`,
  /// the last copied record. Returns whether it has stored one. Waits for each message; ends early,
  /// with false, when a stop is requested. The error is one sentence: NATS is away, or a server of
  /// a later epoch has the session.
  std::expected<bool, std::string> copy(std::uint64_t copied, const std::stop_token& stop);
  /// The last record of the newest snapshot of the stream, or 0 if it is empty.
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
  std::uint64_t kept_from_ = 0;  ///< first message of the newest complete snapshot; 0 if unknown
  std::uint64_t number_ = 0;     ///< of the last snapshot begun
  /// Time of the file that is completely stored.
  std::optional<std::filesystem::file_time_type> done_;
};

/// Greater than any epoch.
inline constexpr std::uint32_t kAnyEpoch = 0xFFFF'FFFF;

/// Stores the newest and the previous snapshot of a session's stream next to its journal, if they
/// are newer than the local ones. They are verified when used (restore()). Returns the last record
/// of the newest local one then, or 0 without one. An error, one sentence, costs only time: all
/// records are replayed. `epoch`: of the caller. The stream must be of an earlier one.
std::expected<std::uint64_t, std::string> fetch_snapshots(NatsConnection& nats,
                                                          const std::string& session,
                                                          std::uint32_t epoch,
                                                          const std::filesystem::path& journal);

}  // namespace kerf
