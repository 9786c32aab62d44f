// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <string>
#include <vector>

#include "server/store/journal_error.h"

namespace kerf {

/// The outcome of salvage_journal().
struct SalvagedJournal {
  std::uint64_t last = 0;         ///< record of the new journal
  std::uint64_t hash = 0;         ///< of its block
  std::uint64_t last_before = 0;  ///< record of the damaged journal
  JournalError damage = {};       ///< with the first bad record; no reason if no record is bad
  /// The record whose block, from a snapshot, the new journal begins with, and the snapshot's file
  /// name. 0 if it begins with the stock.
  std::uint64_t base = 0;
  std::string base_file;
  /// Minimum number of strokes whose cuts are in the new journal's first block, without their
  /// motions.
  std::size_t fixed_strokes = 0;
  /// Records after the base that undo or redo a stroke before it: they have no effect any more.
  std::vector<std::uint64_t> ignored_changes;
  std::vector<std::string> left_out;  ///< other unreadable parts, one sentence each
};

/// Writes the readable part of a damaged journal to a new one, which must not exist. If a snapshot
/// by this version of the kernel includes the bad records, the new journal begins with the block of
/// the newest such snapshot and has the records after it, up to the next bad one. Otherwise it has
/// the records before the first bad one. Records keep their numbers. The new journal is carved
/// before it gets its name. The damaged journal may be in use and is not changed.
std::expected<SalvagedJournal, JournalError> salvage_journal(const std::filesystem::path& from,
                                                             const std::filesystem::path& to);

/// Describes the damage, how the new journal begins and the losses, one sentence each.
std::vector<std::string> describe_salvage(const SalvagedJournal& salvaged);

}  // namespace kerf
