// SPDX-License-Identifier: Apache-2.0
#include "server/store/sqlite.h"

#include <sqlite3.h>
#include <sys/statvfs.h>

#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

namespace kerf {
namespace {

/// Steps of SQLite's virtual machine, a dozen for each row, between two checks for a stop.
constexpr int kStepsBetweenStops = 10'000;

SqlError last_error(sqlite3* database) {
  if (database == nullptr) return {SQLITE_NOMEM, "out of memory"};
  return {sqlite3_extended_errcode(database), sqlite3_errmsg(database)};
}

/// Whether a file cannot change: its file system is mounted read-only, and it has no write-ahead
/// log.
bool is_frozen(const std::filesystem::path& file) {
  struct statvfs system{};
  if (statvfs(file.c_str(), &system) != 0 || (system.f_flag & ST_RDONLY) == 0) return false;
  std::error_code missing;
  const auto log_bytes = std::filesystem::file_size(file.string() + "-wal", missing);
  return missing || log_bytes == 0;
}

/// Returns the URI with which SQLite opens an immutable file, without a log and without shared
/// memory next to it, which would need a writable folder.
std::string frozen_name(const std::filesystem::path& file) {
  std::string name = "file:";
  for (const char byte : file.string()) {
    char code[4];
    std::snprintf(code, sizeof code, "%%%02X", static_cast<unsigned char>(byte));
    const bool is_plain = byte != '%' && byte != '?' && byte != '#';
    name += is_plain ? std::string(1, byte) : code;
  }
  return name + "?immutable=1";
}

}  // namespace

bool is_damage(const SqlError& error) {
  const int primary = error.code & 0xFF;
  return primary == SQLITE_CORRUPT || primary == SQLITE_NOTADB || primary == SQLITE_FORMAT;
}

void SqlStatement::Finalize::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}
void SqlDatabase::Close::operator()(sqlite3* database) const { sqlite3_close_v2(database); }

void SqlStatement::bind(int parameter, std::int64_t value) {
  sqlite3_bind_int64(statement_.get(), parameter, value);
}
void SqlStatement::bind(int parameter, std::string_view text) {
  sqlite3_bind_text64(statement_.get(), parameter, text.data(), text.size(), SQLITE_TRANSIENT,
                      SQLITE_UTF8);
}
void SqlStatement::bind(int parameter, std::span<const std::byte> blob) {
  // A null pointer would mean NULL, which the column may reject.
  const void* bytes = blob.empty() ? static_cast<const void*>("") : blob.data();
  sqlite3_bind_blob64(statement_.get(), parameter, bytes, blob.size(), SQLITE_TRANSIENT);
}

SqlResult<bool> SqlStatement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) {
    sqlite3_reset(statement_.get());
    return false;
  }
  const SqlError error = last_error(sqlite3_db_handle(statement_.get()));
  sqlite3_reset(statement_.get());
  return std::unexpected(error);
}

SqlResult<void> SqlStatement::run() {
  if (auto row = step(); !row) return std::unexpected(row.error());
  return {};
}

std::int64_t SqlStatement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}
std::string SqlStatement::text(int column) const {
  const auto bytes = blob(column);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
std::span<const std::byte> SqlStatement::blob(int column) const {
  const void* data = sqlite3_column_blob(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  return {static_cast<const std::byte*>(data), static_cast<std::size_t>(size)};
}

SqlResult<SqlDatabase> SqlDatabase::open(const std::filesystem::path& file, SqlMode mode) {
  // Open for writing even to read: the first connection after a crash must recover the write-ahead
  // log.
  int flags = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE | SQLITE_OPEN_READWRITE;
  if (mode == SqlMode::kCreate) flags |= SQLITE_OPEN_CREATE;
  std::string name = file.string();
  if (mode == SqlMode::kRead && is_frozen(file)) {
    flags = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE | SQLITE_OPEN_READONLY | SQLITE_OPEN_URI;
    name = frozen_name(file);
  }
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(name.c_str(), &raw, flags, nullptr);
  SqlDatabase database(raw);
  if (code != SQLITE_OK) return std::unexpected(last_error(raw));
  sqlite3_busy_timeout(raw, 5000);
  sqlite3_db_config(raw, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);  // files come from anywhere
  if (mode == SqlMode::kRead) {
    if (auto ok = database.execute("PRAGMA query_only=ON"); !ok) return std::unexpected(ok.error());
  }
  return database;
}

void SqlDatabase::end_on(std::stop_token stop) {
  stop_ = std::make_unique<std::stop_token>(std::move(stop));
  const auto is_stopped = [](void* token) {
    return static_cast<std::stop_token*>(token)->stop_requested() ? 1 : 0;
  };
  sqlite3_progress_handler(database_.get(), kStepsBetweenStops, is_stopped, stop_.get());
}

SqlResult<void> SqlDatabase::execute(const std::string& sql) {
  if (sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
    return std::unexpected(last_error(database_.get()));
  }
  return {};
}

SqlResult<SqlStatement> SqlDatabase::prepare(std::string_view sql) {
  sqlite3_stmt* raw = nullptr;
  const int code = sqlite3_prepare_v3(database_.get(), sql.data(), static_cast<int>(sql.size()),
                                      SQLITE_PREPARE_PERSISTENT, &raw, nullptr);
  if (code != SQLITE_OK) return std::unexpected(last_error(database_.get()));
  return SqlStatement(raw);
}

SqlResult<std::int64_t> SqlDatabase::integer(std::string_view sql) {
  auto statement = prepare(sql);
  if (!statement) return std::unexpected(statement.error());
  const auto row = statement->step();
  if (!row) return std::unexpected(row.error());
  if (!*row) return std::unexpected(SqlError{SQLITE_NOTFOUND, "no row"});
  return statement->integer(0);
}

SqlResult<bool> SqlDatabase::has_table(std::string_view name) {
  auto statement = prepare("SELECT 1 FROM sqlite_master WHERE type='table' AND name=?");
  if (!statement) return std::unexpected(statement.error());
  statement->bind(1, name);
  return statement->step();
}

}  // namespace kerf
