// SPDX-License-Identifier: Apache-2.0
#include "server/store/named_version.h"

#include <algorithm>
#include <array>
#include <span>

#include "server/store/crc32.h"

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

/// Bytes of the UTF-8 character at the front; 0: malformed.
std::size_t character_bytes(std::string_view text) {
  const auto byte = [&](std::size_t n) { return static_cast<unsigned char>(text[n]); };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < bytes) return 0;
  for (std::size_t n = 1; n < bytes; ++n) {
    if ((byte(n) & 0xC0U) != 0x80) return 0;
  }
  // Overlong forms, surrogates, and what is beyond the last character.
  const unsigned second = byte(1);
  const bool is_outside = (first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
                          (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F);
  return is_outside ? 0 : bytes;
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
  if (name.empty() || name.size() > kVersionNameBytesMax) return false;
  const auto is_plain = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x20 && byte != 0x7F && c != '/';
  };
  if (!std::ranges::all_of(name, is_plain)) return false;
  while (!name.empty()) {
    const std::size_t bytes = character_bytes(name);
    if (bytes == 0) return false;
    name.remove_prefix(bytes);
  }
  return true;
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
