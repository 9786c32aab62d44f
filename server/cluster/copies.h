// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <functional>
#include <string>

#include "server/cluster/change_frame.h"
#include "server/cluster/nats_connection.h"

namespace kerf {

/// Joins the messages of a stream to changes. A change with missing parts, because its writer
/// ended, is dropped.
class FrameJoiner {
 public:
  /// Returns the change that this message completes, or nullopt. The error, one sentence, is about
  /// a damaged message or one of an earlier epoch than the previous message.
  std::expected<std::optional<JournalChange>, std::string> add(std::span<const std::byte> message);

 private:
  std::optional<FrameHead> head_;  ///< of the last message
  std::vector<std::byte> rows_;
};

/// The last message of a copy, and the end of the copy at it.
struct CopyEnd {
  std::uint64_t sequence = 0;
  FrameHead head;
};
/// Nullopt without a copy. The error is one sentence.
std::expected<std::optional<CopyEnd>, std::string> end_of_copy(NatsConnection& nats,
                                                               const std::string& session);

/// A fetched copy ends with its last whole change.
struct FetchedCopy {
  CopyPosition position;
  std::uint64_t message = 0;  ///< last message of that change
};
/// Writes the journal of a stream to a new file and verifies it. The error is one sentence.
std::expected<FetchedCopy, std::string> fetch_copy(NatsConnection& nats, const std::string& session,
                                                   const std::filesystem::path& to);

/// `kerf-server copies`: prints a line for each session with a copy at NATS. These three return the
/// exit status: 0, or 1 after printing an error.
int print_copies(const std::string& url);
/// `kerf-server fetch`: writes the journal of a session from its copy.
int fetch_journal(const std::string& url, const std::string& session,
                  const std::filesystem::path& to);
/// `kerf-server forget`: deletes the copy of a session.
int forget_copy(const std::string& url, const std::string& session);

}  // namespace kerf
