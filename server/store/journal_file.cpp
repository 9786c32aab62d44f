// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_file.h"

#include <fcntl.h>
#include <stdio.h>

#include <cerrno>
#include <string>
#include <utility>

#include "server/store/attachment.h"
#include "server/store/chunk_file.h"
#include "server/store/crc32.h"
#include "server/store/list_table.h"
#include "server/store/private_file.h"

namespace kerf {
namespace {

// Not WITHOUT ROWID: rows arrive in the order of their integer key, and a rowid table appends them
// in place.
constexpr const char* kTables = R"(
  CREATE TABLE session(id TEXT NOT NULL, scene TEXT NOT NULL, crc INTEGER NOT NULL,
                       base_folder TEXT NOT NULL, epoch INTEGER NOT NULL);
  CREATE TABLE participants(participant INTEGER PRIMARY KEY, name TEXT NOT NULL,
                            color TEXT NOT NULL, kind TEXT NOT NULL);
  CREATE TABLE state_hashes(sequence INTEGER PRIMARY KEY, hash INTEGER NOT NULL);
  CREATE TABLE kernel_versions(sequence INTEGER PRIMARY KEY, version INTEGER NOT NULL);
)";

/// Tables since version 2. Version 1 stored each record as a row of the table `commands`.
constexpr const char* kTables2 = R"(
  CREATE TABLE IF NOT EXISTS agents(participant INTEGER PRIMARY KEY, token BLOB NOT NULL,
                                    agent_sequence INTEGER NOT NULL, crc INTEGER NOT NULL);
  CREATE TABLE IF NOT EXISTS batches(first INTEGER PRIMARY KEY, count INTEGER NOT NULL,
                       wall_ms INTEGER NOT NULL, span_ms INTEGER NOT NULL, bytes BLOB NOT NULL,
                       crc INTEGER NOT NULL);
)";

std::string set_version() { return "PRAGMA user_version=" + std::to_string(kJournalVersion) + ";"; }

/// Updates a journal to this version. Records of version 1 stay in their table.
SqlResult<void> migrate(SqlDatabase& database) {
  // The first journals lacked the table of kernel versions.
  return database.execute(
      "BEGIN;CREATE TABLE IF NOT EXISTS kernel_versions"
      "(sequence INTEGER PRIMARY KEY, version INTEGER NOT NULL);" +
      std::string(kTables2) + set_version() + "COMMIT");
}

/// Created only if the scene names files.
constexpr const char* kFilesTable =
    "CREATE TABLE files(name TEXT PRIMARY KEY, bytes BLOB NOT NULL, crc INTEGER NOT NULL)";

SqlResult<void> insert_files(SqlDatabase& database,
                             const std::map<std::string, std::string>& files) {
  if (files.empty()) return {};
  if (auto ok = database.execute(kFilesTable); !ok) return ok;
  auto insert = database.prepare("INSERT INTO files VALUES(?,?,?)");
  if (!insert) return std::unexpected(insert.error());
  for (const auto& [name, text] : files) {
    const auto bytes = std::as_bytes(std::span(text));
    insert->bind(1, name);
    insert->bind(2, bytes);
    insert->bind(3, std::int64_t{crc32(bytes)});
    if (auto row = insert->step(); !row) return std::unexpected(row.error());
  }
  return {};
}

/// Suffixes of the side files: SQLite's write-ahead log and its index, which remain after a crash,
/// the snapshots (block_snapshot.h), an unfinished snapshot, and the mark of a copy.
constexpr const char* kSideFileSuffixes[] = {
    "-wal", "-shm", "-snapshot", "-snapshot-previous", "-snapshot.tmp", kCopiedSuffix};

JournalError make_error(JournalErrorCode code, const std::filesystem::path& file,
                        std::string reason) {
  return {code, file.string(), 0, std::move(reason)};
}

}  // namespace

const char* to_string(JournalErrorCode code) {
  switch (code) {
    case JournalErrorCode::kNotFound:
      return "journal_not_found";
    case JournalErrorCode::kExists:
      return "journal_exists";
    case JournalErrorCode::kNotAJournal:
      return "not_a_journal";
    case JournalErrorCode::kForeignVersion:
      return "foreign_journal_version";
    case JournalErrorCode::kCorrupt:
      return "corrupt_journal";
    case JournalErrorCode::kIo:
      return "journal_io";
    case JournalErrorCode::kFull:
      return "journal_full";
    case JournalErrorCode::kSessionLimit:
      return "session_limit";
    case JournalErrorCode::kDiskLimit:
      return "disk_limit";
    case JournalErrorCode::kLease:
      return "no_lease";
    case JournalErrorCode::kNotCopied:
      return "not_copied";
    case JournalErrorCode::kNotLoaded:
      return "journal_not_loaded";
  }
  return "journal_io";
}

std::string describe(const JournalError& error) {
  std::string text = error.file + ": ";
  if (error.sequence != 0) text += "record " + std::to_string(error.sequence) + ": ";
  return text + error.reason;
}

JournalError to_journal_error(const std::filesystem::path& file, const SqlError& error) {
  const auto code = is_damage(error) ? JournalErrorCode::kCorrupt : JournalErrorCode::kIo;
  return make_error(code, file, error.reason);
}

std::expected<SqlDatabase, JournalError> create_journal(const std::filesystem::path& file,
                                                        const JournalHeader& header,
                                                        CreateMode mode) {
  if (const auto error = create_private_file(file)) {
    if (error != std::errc::file_exists) {
      return std::unexpected(make_error(JournalErrorCode::kIo, file, error.message()));
    }
    return std::unexpected(
        make_error(JournalErrorCode::kExists, file, "the journal already exists"));
  }
  auto database = SqlDatabase::open(file, SqlMode::kCreate);
  if (!database) {
    remove_journal(file);
    return std::unexpected(to_journal_error(file, database.error()));
  }
  const auto fill = [&]() -> SqlResult<void> {
    const std::string log = mode == CreateMode::kLive ? "WAL" : "OFF";
    const std::string begin = "PRAGMA journal_mode=" + log + "; PRAGMA synchronous=FULL; BEGIN;";
    if (auto ok = database->execute(begin + kTables); !ok) return ok;
    if (auto ok = create_list_tables(*database); !ok) return ok;
    if (auto ok = create_attachment_table(*database); !ok) return ok;
    // The table of records comes last in the file, so a truncated file is detected as damaged.
    const std::string setup = std::string(kTables2) +
                              "PRAGMA application_id=" + std::to_string(kJournalApplicationId) +
                              ";" + set_version();
    if (auto ok = database->execute(setup); !ok) return ok;
    auto insert = database->prepare("INSERT INTO session VALUES(?,?,?,?,1)");
    if (!insert) return std::unexpected(insert.error());
    insert->bind(1, header.session);
    insert->bind(2, header.scene_json);
    insert->bind(3, std::int64_t{crc32(std::as_bytes(std::span(header.scene_json)))});
    insert->bind(4, header.base_folder);
    if (auto row = insert->step(); !row) return std::unexpected(row.error());
    if (auto ok = insert_files(*database, header.files); !ok) return ok;
    const std::string version =
        "INSERT INTO kernel_versions VALUES(0," + std::to_string(header.kernel_version) + ")";
    if (auto ok = database->execute(version); !ok) return ok;
    return database->execute("COMMIT");
  };
  if (auto ok = fill(); !ok) {
    const JournalError error = to_journal_error(file, ok.error());
    database = std::unexpected(ok.error());  // close it
    remove_journal(file);
    return std::unexpected(error);
  }
  return *std::move(database);
}

std::expected<SqlDatabase, JournalError> open_journal(const std::filesystem::path& file,
                                                      SqlMode mode) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    return std::unexpected(
        make_error(JournalErrorCode::kNotFound, file, "the journal does not exist"));
  }
  auto database = SqlDatabase::open(file, mode);
  if (!database) return std::unexpected(to_journal_error(file, database.error()));
  const auto application = database->integer("PRAGMA application_id");
  if (!application) {
    auto error = to_journal_error(file, application.error());
    if (error.code == JournalErrorCode::kCorrupt) error.code = JournalErrorCode::kNotAJournal;
    return std::unexpected(error);
  }
  if (*application != kJournalApplicationId) {
    return std::unexpected(make_error(JournalErrorCode::kNotAJournal, file,
                                      "the file is an SQLite database but not a Kerf journal"));
  }
  const auto version = database->integer("PRAGMA user_version");
  if (!version) return std::unexpected(to_journal_error(file, version.error()));
  if (*version < kOldestJournalVersion || *version > kJournalVersion) {
    return std::unexpected(make_error(JournalErrorCode::kForeignVersion, file,
                                      "journal version " + std::to_string(*version) +
                                          " is not supported; this program reads versions " +
                                          std::to_string(kOldestJournalVersion) + " to " +
                                          std::to_string(kJournalVersion)));
  }
  // A journal has tables only. Views and triggers of a stranger's file would run with each query.
  const auto foreign =
      database->integer("SELECT count(*) FROM sqlite_master WHERE type IN ('view', 'trigger')");
  if (!foreign) return std::unexpected(to_journal_error(file, foreign.error()));
  if (*foreign > 0) {
    return std::unexpected(make_error(JournalErrorCode::kNotAJournal, file,
                                      "the file has views or triggers, which no journal has"));
  }
  if (mode == SqlMode::kWrite) {
    std::filesystem::remove(file.string() + kCopiedSuffix, ignored);  // usually absent
    const std::string setup = "PRAGMA synchronous=FULL; UPDATE session SET epoch=epoch+1";
    if (*version < kJournalVersion) {
      if (auto ok = migrate(*database); !ok) {
        return std::unexpected(to_journal_error(file, ok.error()));
      }
    }
    if (auto ok = database->execute(setup); !ok) {
      return std::unexpected(to_journal_error(file, ok.error()));
    }
    if (auto ok = create_list_tables(*database); !ok) {
      return std::unexpected(to_journal_error(file, ok.error()));
    }
    if (auto ok = create_attachment_table(*database); !ok) {
      return std::unexpected(to_journal_error(file, ok.error()));
    }
  }
  return *std::move(database);
}

std::expected<void, JournalError> raise_epoch(const std::filesystem::path& file,
                                              std::uint32_t least) {
  auto database = SqlDatabase::open(file, SqlMode::kWrite);
  if (!database) return std::unexpected(to_journal_error(file, database.error()));
  const std::string before = std::to_string(std::int64_t{least} - 1);
  auto raised = database->execute("UPDATE session SET epoch=max(epoch," + before + ")");
  if (!raised) return std::unexpected(to_journal_error(file, raised.error()));
  return {};
}

std::expected<void, JournalError> copy_journal(const std::filesystem::path& from,
                                               const std::filesystem::path& to) {
  auto database = open_journal(from, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  // Allow VACUUM INTO, which query_only forbids although it does not change this file.
  if (auto ok = database->execute("PRAGMA query_only=OFF"); !ok) {
    return std::unexpected(to_journal_error(from, ok.error()));
  }
  auto copy = database->prepare("VACUUM INTO ?");
  if (!copy) return std::unexpected(to_journal_error(from, copy.error()));
  copy->bind(1, to.string());
  // SQLite also writes into an empty file, but would itself create a world-readable one.
  const bool is_new = !create_private_file(to);
  const auto row = copy->step();
  if (row) return {};
  if (is_new) remove_journal(to);
  const bool is_damaged = is_damage(row.error());
  return std::unexpected(to_journal_error(is_damaged ? from : to, row.error()));
}

std::error_code rename_new(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return {};
  if (errno != EINVAL) return {errno, std::generic_category()};
  // Fallback for file systems without an atomic operation. Only this server moves files here.
  std::error_code error;
  if (std::filesystem::exists(to, error)) return make_error_code(std::errc::file_exists);
  std::filesystem::rename(from, to, error);
  return error;
}

std::expected<std::filesystem::path, std::error_code> keep_journal(
    const std::filesystem::path& from, const std::filesystem::path& folder,
    const std::string& name) {
  for (int n = 1;; ++n) {
    auto to = folder / (name + (n > 1 ? "-" + std::to_string(n) : "") + kJournalExtension);
    const std::error_code error = rename_new(from, to);
    if (error == std::errc::file_exists) continue;
    if (error) return std::unexpected(error);
    std::error_code ignored;
    for (const char* suffix : kSideFileSuffixes) {  // usually absent
      std::filesystem::rename(from.string() + suffix, to.string() + suffix, ignored);
    }
    return to;
  }
}

std::expected<std::filesystem::path, JournalError> unfinished_journal(
    const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored)) {
    return std::unexpected(
        JournalError{JournalErrorCode::kExists, file.string(), 0, "the file already exists"});
  }
  auto unfinished = unfinished_file(file);
  remove_journal(unfinished);
  return unfinished;
}

void remove_journal(const std::filesystem::path& file) {
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  for (const char* suffix : kSideFileSuffixes) {
    std::filesystem::remove(file.string() + suffix, ignored);
  }
}

}  // namespace kerf
