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
  JournalError damage = {};       ///< with the first bad record; no reason: no record is bad
  /// The record after which a snapshot holds the block with which the new journal begins, and the
  /// name of its file; 0: it begins with the stock.
  std::uint64_t base = 0;
  std::string base_file;
  /// The least number of strokes of which the new journal has the cuts and not the motions.
  std::size_t fixed_strokes = 0;
  /// Records behind the base that undo or redo a stroke before it, which has no effect any more.
  std::vector<std::uint64_t> ignored_changes;
  std::vector<std::string> left_out;  ///< what else could not be read, one sentence each
};

/// Writes what can be read of a damaged journal to a new one, which must not exist. If one of its
/// snapshots, of this version of the kernel, holds the bad records, the new journal begins with
/// the block of the newest such one, and has the records after it up to the next bad one; otherwise
/// it has those before the first bad one. Records keep their numbers. The new journal is carved
/// before it gets its name. Changes nothing of the damaged one, which may be in use.
std::expected<SalvagedJournal, JournalError> salvage_journal(const std::filesystem::path& from,
                                                             const std::filesystem::path& to);

/// What was wrong, what the new journal begins with and what is lost, a sentence each.
std::vector<std::string> describe_salvage(const SalvagedJournal& salvaged);

}  // namespace kerf
