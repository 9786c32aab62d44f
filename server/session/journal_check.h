// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "server/store/journal_error.h"

namespace kerf {

/// A fault of a file in a data folder, and its remedy.
struct FileFault {
  std::string problem, remedy;  ///< one sentence each
};

/// A journal or snapshot that has been read from its beginning to its end.
struct CheckedFile {
  std::string name;     ///< of the file
  std::string summary;  ///< contents; empty if unreadable
  std::vector<FileFault> faults;
};

/// Reads a journal and verifies its checksums and its pages, without cutting anything.
CheckedFile check_journal(const std::filesystem::path& file);

/// Reads the journals and snapshots of a data folder and verifies their checksums, without cutting
/// anything. Calls `report` for each file, sorted by name. Fails if the folder cannot be read.
std::expected<void, JournalError> check_folder(
    const std::filesystem::path& folder, const std::function<void(const CheckedFile&)>& report);

/// The outcome of verify_journal.
struct VerifiedJournal {
  std::uint64_t records = 0, motions = 0, hash = 0;
  std::size_t hashes_compared = 0;
  int snapshots_compared = 0;
  /// The first difference, with its record, participant and time; empty if none.
  std::string difference;
  std::string note;  ///< what could not be compared and why; empty if everything was
};

/// Carves a journal from its first record. Compares the solid with the snapshots and with each
/// stored hash that this version of the kernel computed. Changes no file.
std::expected<VerifiedJournal, JournalError> verify_journal(const std::filesystem::path& file);

}  // namespace kerf
