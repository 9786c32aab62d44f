// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>

#include "kernel/kernel_version.h"
#include "server/store/journal_error.h"
#include "server/store/sqlite.h"

namespace kerf {

/// Extension of the file name of a journal.
inline constexpr const char* kJournalExtension = ".kerf";
/// The application_id of the SQLite file, "KERF", which identifies journals.
inline constexpr std::int64_t kJournalApplicationId = 0x4B455246;
/// Suffix of an empty file that marks a journal made from changes, until the journal is opened for
/// writing.
inline constexpr const char* kCopiedSuffix = "-copied";
/// Version of the tables. Opening an older file for writing updates its tables but not its records.
/// A newer one is rejected with kForeignVersion.
inline constexpr std::int64_t kJournalVersion = 2;
inline constexpr std::int64_t kOldestJournalVersion = 1;
/// Kernel version of a journal that stores none.
inline constexpr std::int64_t kFirstKernelVersion = 1;

/// The parameters of a session.
struct JournalHeader {
  std::string session;
  std::string scene_json;
  std::string base_folder;  ///< folder of the scene's file references; empty if none
  std::uint32_t epoch = 1;  ///< number of openings for writing
  std::map<std::string, std::string> files = {};  ///< contents of the scene's files, by name
  /// Version of the kernel that computed the newest state hash.
  std::int64_t kernel_version = kKernelVersion;
  /// First record whose hash that version computed. Ignored when writing.
  std::uint64_t kernel_since = 0;
};

/// How a new journal is written. kLive uses a write-ahead log. kCopy writes directly to the file,
/// which halves the space needed, but a crash damages the file.
enum class CreateMode { kLive, kCopy };

/// Creates an empty journal. Fails with kExists if the file exists.
std::expected<SqlDatabase, JournalError> create_journal(const std::filesystem::path& file,
                                                        const JournalHeader& header,
                                                        CreateMode mode = CreateMode::kLive);
/// Opens a journal and checks its application_id and version.
std::expected<SqlDatabase, JournalError> open_journal(const std::filesystem::path& file,
                                                      SqlMode mode);
/// Raises the epoch of the next opening for writing to at least `least`.
std::expected<void, JournalError> raise_epoch(const std::filesystem::path& file,
                                              std::uint32_t least);
/// Writes a consistent copy of a journal, even while a writer uses it.
std::expected<void, JournalError> copy_journal(const std::filesystem::path& from,
                                               const std::filesystem::path& to);
/// Moves a closed journal, its snapshots and SQLite's side files to `folder`/NAME.kerf, or
/// NAME-2.kerf and so on if that name is taken. Never overwrites a file. Returns the new path.
std::expected<std::filesystem::path, std::error_code> keep_journal(
    const std::filesystem::path& from, const std::filesystem::path& folder,
    const std::string& name);
/// Renames a file. Fails with file_exists instead of replacing another file.
std::error_code rename_new(const std::filesystem::path& from, const std::filesystem::path& to);
/// Returns the temporary name under which to create the journal `file`, and deletes a file of that
/// name, which a crash may have left. Fails with kExists if `file` exists.
std::expected<std::filesystem::path, JournalError> unfinished_journal(
    const std::filesystem::path& file);
/// Deletes a journal, its snapshots and SQLite's side files. Ignores errors.
void remove_journal(const std::filesystem::path& file);
/// Converts an SQLite error to kCorrupt if the file is damaged, otherwise to kIo.
JournalError to_journal_error(const std::filesystem::path& file, const SqlError& error);

}  // namespace kerf
