// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "server/store/journal_error.h"
#include "server/store/sqlite.h"

namespace kerf {

/// "KERF" in the header of the SQLite file: tells our files from those of other programs.
inline constexpr std::int64_t kJournalApplicationId = 0x4B455246;
/// Version of the tables. A file with another version is rejected with kForeignVersion, never
/// guessed at.
inline constexpr std::int64_t kJournalVersion = 1;

/// What a session is, apart from what happened in it.
struct JournalHeader {
  std::string session;
  std::string scene_json;
  std::string base_folder;  ///< where the scene's file references start; empty: it has none
  std::uint32_t epoch = 1;  ///< how often the session was opened for writing
  std::map<std::string, std::string> files = {};  ///< that the scene names, by those names
};

/// Creates an empty journal; kExists if the file is already there.
std::expected<SqlDatabase, JournalError> create_journal(const std::filesystem::path& file,
                                                        const JournalHeader& header);
/// Opens a journal and checks its identity and version.
std::expected<SqlDatabase, JournalError> open_journal(const std::filesystem::path& file,
                                                      SqlMode mode);
/// Writes a complete copy of a journal as it is now, while it may be written to.
std::expected<void, JournalError> copy_journal(const std::filesystem::path& from,
                                               const std::filesystem::path& to);
/// Turns what SQLite said into what a caller of the store can act on.
JournalError to_journal_error(const std::filesystem::path& file, const SqlError& error);

}  // namespace kerf
