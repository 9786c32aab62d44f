// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <vector>

#include "kernel/sculpture.h"

namespace kerf {

/// Names a participant within one session; 0 is the session itself (it defines the scene's tools).
using ParticipantId = std::uint32_t;

/// One command of a session, in the order in which it was applied.
struct JournalRecord {
  std::uint64_t sequence = 0;  ///< from 1, consecutive
  ParticipantId participant = 0;
  Command command;
};

/// The first byte of an encoded command names its layout. A changed layout gets a new number; the
/// old one stays readable.
enum class CommandLayout : std::uint8_t {
  kDefineTool1 = 1,  ///< cutting pieces only: balls and frusta
  kMoveTool1 = 2,
  kDefineTool2 = 3  ///< cutting pieces, then non-cutting ones; arcs too
};

/// A command as bytes: layout number, then fixed-width little-endian fields (doubles as IEEE 754
/// bits, so that replay sees the very same numbers).
std::vector<std::byte> encode_command(const Command& command);

/// The reverse of encode_command. Checks lengths and numbers of pieces; the sculpture checks the
/// meaning. The error is one sentence.
std::expected<Command, std::string> decode_command(std::span<const std::byte> bytes);

/// Checksum over everything that a stored record says, so that a row that moved or changed owner is
/// noticed too.
std::uint32_t record_checksum(std::uint64_t sequence, ParticipantId participant,
                              std::span<const std::byte> bytes);

}  // namespace kerf
