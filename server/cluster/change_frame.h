// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/cluster/nats_connection.h"
#include "server/store/journal_change.h"

namespace kerf {

/// Bytes of rows in one message. Changes are divided, because NATS accepts 1 MB by default.
inline constexpr std::size_t kFrameBytes = std::size_t{256} << 10;

/// Head of a message of a session's stream: its writer, its change and its part.
struct FrameHead {
  std::uint32_t epoch = 0;   ///< of the journal that the rows are from
  std::uint64_t writer = 0;  ///< random, for each run of a replica
  std::uint64_t change = 0;  ///< number of the change, counted by its writer from 1
  std::uint32_t part = 0, parts = 1;
  bool is_whole = true;  ///< JournalChange::is_whole
  CopyPosition before, after;

  bool is_last() const { return part + 1 == parts; }
  /// End of a copy whose last message is this one.
  const CopyPosition& position() const { return is_last() ? after : before; }
};

/// Encodes a part of a change as the bytes of a message (README.md, "Messages").
std::vector<std::byte> encode_frame(const FrameHead& head, std::span<const std::byte> rows);

struct Frame {
  FrameHead head;
  std::span<const std::byte> rows;  ///< within the bytes that were decoded
};
/// Nullopt for damaged bytes, or another version of the format.
std::optional<Frame> decode_frame(std::span<const std::byte> bytes);

/// The stream and the subject of the copy of a session's journal.
std::string copy_stream(const std::string& session);
std::string copy_subject(const std::string& session);
/// The session of such a stream; nullopt for other streams.
std::optional<std::string> session_of_stream(const std::string& stream);

}  // namespace kerf
