// SPDX-License-Identifier: Apache-2.0
#include "server/store/named_version.h"

#include <array>
#include <span>

#include "server/store/crc32.h"
#include "server/store/plain_text.h"

namespace kerf {
namespace {

std::int64_t checksum(const NamedVersion& version) {
  std::uint32_t crc = 0;
  for (const std::string* text : {&version.name, &version.author, &version.person}) {
    crc = crc32(std::as_bytes(std::span(text->c_str(), text->size() + 1)), crc);
  }
  const std::array numbers = {static_cast<std::int64_t>(version.record), version.record_ms,
                              version.created_ms};
  return crc32(std::as_bytes(std::span(numbers)), crc);
}

SqlResult<void> delete_row(SqlDatabase& database, const std::string& name) {
  auto statement = database.prepare("DELETE FROM versions WHERE name=?");
  if (!statement) return std::unexpected(statement.error());
  statement->bind(1, name);
  if (auto row = statement->step(); !row) return std::unexpected(row.error());
  return {};
}

}  // namespace

bool is_version_name(std::string_view name) {
  return is_plain_text(name, kVersionNameBytesMax) && !name.contains('/');
}

SqlResult<void> create_version_table(SqlDatabase& database) {
  return database.execute(
      "CREATE TABLE IF NOT EXISTS versions(name TEXT PRIMARY KEY, record INTEGER NOT NULL, "
      "record_ms INTEGER NOT NULL, created_ms INTEGER NOT NULL, author TEXT NOT NULL, "
      "person TEXT NOT NULL, crc INTEGER NOT NULL) WITHOUT ROWID");
}

SqlResult<void> store_version(SqlDatabase& database, const VersionChange& change) {
  const NamedVersion& version = change.version;
  if (!change.old_name.empty()) {
    if (auto ok = delete_row(database, change.old_name); !ok) return ok;
  }
  if (change.is_removed) return delete_row(database, version.name);
  auto statement = database.prepare("INSERT OR REPLACE INTO versions VALUES(?,?,?,?,?,?,?)");
  if (!statement) return std::unexpected(statement.error());
  statement->bind(1, version.name);
  statement->bind(2, static_cast<std::int64_t>(version.record));
  statement->bind(3, version.record_ms);
  statement->bind(4, version.created_ms);
  statement->bind(5, version.author);
  statement->bind(6, version.person);
  statement->bind(7, checksum(version));
  if (auto row = statement->step(); !row) return std::unexpected(row.error());
  return {};
}

SqlResult<std::vector<NamedVersion>> read_versions(SqlDatabase& database, std::uint64_t last) {
  std::vector<NamedVersion> versions;
  const auto exists = database.has_table("versions");
  if (!exists) return std::unexpected(exists.error());
  if (!*exists) return versions;
  auto rows = database.prepare(
      "SELECT name, record, record_ms, created_ms, author, person, crc FROM versions "
      "WHERE record<=" +
      std::to_string(last) + " ORDER BY name");
  if (!rows) return std::unexpected(rows.error());
  for (;;) {
    const auto row = rows->step();
    if (!row) return std::unexpected(row.error());
    if (!*row) return versions;
    NamedVersion version{rows->text(0),    static_cast<std::uint64_t>(rows->integer(1)),
                         rows->integer(2), rows->integer(3),
                         rows->text(4),    rows->text(5)};
    if (rows->integer(6) == checksum(version)) versions.push_back(std::move(version));
  }
}

}  // namespace kerf
