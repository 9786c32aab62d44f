// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "kernel/sculpture.h"

namespace kerf {

/// Number of a participant within one session. 0 is the session itself, which defines the tools.
using ParticipantId = std::uint32_t;

/// Undoes or redoes the motions of a stroke. The block is the stock minus all motions not undone,
/// in any order, so later cuts by other participants stay.
struct StrokeChange {
  std::uint64_t stroke = 0;  ///< its first record
  bool undone = true;        ///< false to redo it
};

/// A command that changes the block of a session.
using RecordedCommand = std::variant<DefineTool, MoveTool, StrokeChange>;

/// Wraps a kernel command for the journal.
RecordedCommand recorded(Command command);
/// Returns the kernel command of a record; nullopt for a StrokeChange.
std::optional<Command> kernel_command(const RecordedCommand& command);

/// One command of a session.
struct JournalRecord {
  std::uint64_t sequence = 0;  ///< order of application: from 1, consecutive
  ParticipantId participant = 0;
  RecordedCommand command;
  /// When it was appended, ms since 1970 UTC, to about 10 ms. 0 in a journal of version 1.
  std::int64_t wall_ms = 0;
  /// First record of its stroke: the cuts of a participant between touching down and lifting, or a
  /// program. 0 for none and in a journal of version 1.
  std::uint64_t stroke = 0;
};

/// The first byte of an encoded command. A changed layout gets a new number, and old ones stay
/// readable.
enum class CommandLayout : std::uint8_t {
  kDefineTool1 = 1,  ///< cutting pieces only: balls and frusta
  kMoveTool1 = 2,
  kDefineTool2 = 3,  ///< cutting pieces, then non-cutting ones; arcs too
  kStrokeChange1 = 4
};

/// Encodes a command: layout number, then fixed-width little-endian fields. Doubles are stored as
/// IEEE 754 bits, so replay reads identical numbers.
std::vector<std::byte> encode_command(const RecordedCommand& command);

/// Decodes a command. Checks lengths, piece counts and tool shapes, but not the rest: see
/// Sculpture::check. The error is one sentence.
std::expected<RecordedCommand, std::string> decode_command(std::span<const std::byte> bytes);

/// Returns the CRC-32 of sequence, participant and bytes, which also detects a record that was
/// moved or attributed to another participant.
std::uint32_t record_checksum(std::uint64_t sequence, ParticipantId participant,
                              std::span<const std::byte> bytes);
/// Returns the CRC-32 of an agent's progress: the number of its newest sample in the journal, and
/// the hash of its token.
std::uint32_t progress_checksum(ParticipantId participant, std::uint64_t agent_sequence,
                                std::span<const std::byte> token);

}  // namespace kerf
