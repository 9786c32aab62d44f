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
/// "KERF", the application_id of the SQLite file. It identifies journals.
inline constexpr std::int64_t kJournalApplicationId = 0x4B455246;
/// Beside a journal that was made from changes there is an empty file of its name with this at the
/// end, until the journal is opened for writing.
inline constexpr const char* kCopiedSuffix = "-copied";
/// Version of the tables. Opening a file of an older version for writing makes it one of this
/// version; its records stay as they are. A newer one is rejected with kForeignVersion.
inline constexpr std::int64_t kJournalVersion = 2;
inline constexpr std::int64_t kOldestJournalVersion = 1;
/// Kernel version of a journal that stores none.
inline constexpr std::int64_t kFirstKernelVersion = 1;

/// The parameters of a session.
struct JournalHeader {
  std::string session;
  std::string scene_json;
  std::string base_folder;  ///< of the scene's file references; empty: none
  std::uint32_t epoch = 1;  ///< number of times the journal was opened for writing
  std::map<std::string, std::string> files = {};  ///< contents of the scene's files, by name
  /// Version of the kernel that computed the newest state hash.
  std::int64_t kernel_version = kKernelVersion;
  /// The first record whose hash that version has computed. Read only.
  std::uint64_t kernel_since = 0;
};

/// How a new journal is written: kLive through a write-ahead log; kCopy straight to the file, which
/// needs no space twice and is damaged after a crash.
enum class CreateMode { kLive, kCopy };

/// Creates an empty journal; fails with kExists if the file exists.
std::expected<SqlDatabase, JournalError> create_journal(const std::filesystem::path& file,
                                                        const JournalHeader& header,
                                                        CreateMode mode = CreateMode::kLive);
/// Opens a journal and checks its application_id and version.
std::expected<SqlDatabase, JournalError> open_journal(const std::filesystem::path& file,
                                                      SqlMode mode);
/// Makes the next opening for writing one of epoch `least`, if it would be of a smaller one.
std::expected<void, JournalError> raise_epoch(const std::filesystem::path& file,
                                              std::uint32_t least);
/// Writes a consistent copy of a journal, which may be in use by a writer.
std::expected<void, JournalError> copy_journal(const std::filesystem::path& from,
                                               const std::filesystem::path& to);
/// Moves a closed journal, its snapshot, and the files that SQLite may have left beside it, to
/// `folder`/NAME.kerf, or NAME-2.kerf and so on if that name is taken: no file is overwritten.
/// Returns the new path.
std::expected<std::filesystem::path, std::error_code> keep_journal(
    const std::filesystem::path& from, const std::filesystem::path& folder,
    const std::string& name);
/// Renames a file; fails with file_exists instead of replacing another one.
std::error_code rename_new(const std::filesystem::path& from, const std::filesystem::path& to);
/// Deletes a journal, its snapshot, and the files that SQLite may have left beside it. Errors are
/// ignored.
void remove_journal(const std::filesystem::path& file);
/// Converts an SQLite error: kCorrupt if the file is damaged, otherwise kIo.
JournalError to_journal_error(const std::filesystem::path& file, const SqlError& error);

}  // namespace kerf
