// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <functional>
#include <string>

#include "server/cluster/change_frame.h"
#include "server/cluster/nats_connection.h"

namespace kerf {

/// Puts the messages of a stream together to changes again. A change of which parts are missing,
/// because its writer ended, is left out.
class FrameJoiner {
 public:
  /// Returns the change that is complete with this message; nullopt if none is. The error, one
  /// sentence, is of a damaged message or one of an earlier epoch than the message before.
  std::expected<std::optional<JournalChange>, std::string> add(std::span<const std::byte> message);

 private:
  std::optional<FrameHead> head_;  ///< of the last message
  std::vector<std::byte> rows_;
};

/// The last message of a copy, and how far the copy goes with it.
struct CopyEnd {
  std::uint64_t sequence = 0;
  FrameHead head;
};
/// Nullopt: there is no copy. The error is one sentence.
std::expected<std::optional<CopyEnd>, std::string> end_of_copy(NatsConnection& nats,
                                                               const std::string& session);

/// A copy that was fetched ends with its last change that is whole.
struct FetchedCopy {
  CopyPosition position;
  std::uint64_t message = 0;  ///< the last one of that change
};
/// Writes the journal that a stream is the copy of to a new file, and verifies it. The error is one
/// sentence.
std::expected<FetchedCopy, std::string> fetch_copy(NatsConnection& nats, const std::string& session,
                                                   const std::filesystem::path& to);

/// `kerf-server copies`: prints a line for each session with a copy at NATS. These three return the
/// exit status: 0, or 1 after an error, which they print.
int print_copies(const std::string& url);
/// `kerf-server fetch`: writes the journal of a session from its copy.
int fetch_journal(const std::string& url, const std::string& session,
                  const std::filesystem::path& to);
/// `kerf-server forget`: deletes the copy of a session.
int forget_copy(const std::string& url, const std::string& session);

}  // namespace kerf
