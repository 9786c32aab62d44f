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

/// Encodes a part of a change as the bytes of a message, little-endian: u32 "KRFC", u32 version 1,
/// u32 CRC-32 of the rest; u32 epoch, u64 writer, u64 change, u32 part, u32 parts, u8 1 if the
/// change is whole; the positions before and after, each u64 last record, u64 record of the last
/// state hash, u32 checksum of the scene, u32 checksum of the row with the last record; then the
/// rows.
///
/// A row is u8 table (store/journal_tables.h), u8 1 put, 2 remove or 3 clear; for put all columns,
/// for remove the key: integers as i64, texts and bytes as u32 length and bytes. The id of a
/// message is session/epoch/writer/change/part, so a message whose acknowledgement was lost is not
/// stored twice.
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
/// The session of such a stream, or nullopt for other streams.
std::optional<std::string> session_of_stream(const std::string& stream);

}  // namespace kerf
