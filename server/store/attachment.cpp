// SPDX-License-Identifier: Apache-2.0
#include "server/store/attachment.h"

#include <span>
#include <utility>

#include "server/store/crc32.h"
#include "server/store/journal_file.h"

namespace kerf {
namespace {

std::int64_t checksum(const std::string& kind, const std::string& name,
                      std::span<const std::byte> bytes) {
  std::uint32_t crc = 0;
  for (const std::string* text : {&kind, &name}) {
    crc = crc32(std::as_bytes(std::span(text->c_str(), text->size() + 1)), crc);
  }
  return crc32(bytes, crc);
}

}  // namespace

SqlResult<void> create_attachment_table(SqlDatabase& database) {
  return database.execute(
      "CREATE TABLE IF NOT EXISTS attachments(number INTEGER PRIMARY KEY, kind TEXT NOT NULL, "
      "name TEXT NOT NULL, bytes BLOB NOT NULL, crc INTEGER NOT NULL);"
      "CREATE INDEX IF NOT EXISTS attachment_names ON attachments(kind, name);"
      "CREATE TABLE IF NOT EXISTS program_lines(participant INTEGER PRIMARY KEY, line INTEGER NOT "
      "NULL)");
}

SqlResult<std::int64_t> last_attachment(SqlDatabase& database) {
  return database.integer("SELECT coalesce(max(number),0) FROM attachments");
}

SqlResult<void> store_attachment(SqlDatabase& database, const AttachmentChange& change,
                                 std::int64_t number) {
  if (change.kind.empty()) return database.execute("DELETE FROM attachments");
  auto removal = database.prepare("DELETE FROM attachments WHERE kind=? AND name=?");
  if (!removal) return std::unexpected(removal.error());
  removal->bind(1, change.kind);
  removal->bind(2, change.name);
  if (auto ok = removal->run(); !ok) return ok;
  if (!change.bytes) return {};
  auto insert = database.prepare("INSERT INTO attachments VALUES(?,?,?,?,?)");
  if (!insert) return std::unexpected(insert.error());
  insert->bind(1, number);
  insert->bind(2, change.kind);
  insert->bind(3, change.name);
  insert->bind(4, std::span<const std::byte>(*change.bytes));
  insert->bind(5, checksum(change.kind, change.name, *change.bytes));
  return insert->run();
}

std::expected<std::vector<Attachment>, JournalError> read_attachments(
    const std::filesystem::path& journal) {
  auto database = open_journal(journal, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  const auto failed = [&](const SqlError& error) {
    return std::unexpected(to_journal_error(journal, error));
  };
  std::vector<Attachment> list;
  const auto exists = database->has_table("attachments");
  if (!exists) return failed(exists.error());
  if (!*exists) return list;
  auto rows = database->prepare("SELECT kind, name, bytes, crc FROM attachments ORDER BY number");
  if (!rows) return failed(rows.error());
  for (;;) {
    const auto row = rows->step();
    if (!row) return failed(row.error());
    if (!*row) return list;
    const auto bytes = rows->blob(2);
    Attachment found{rows->text(0), rows->text(1), {bytes.begin(), bytes.end()}};
    if (rows->integer(3) == checksum(found.kind, found.name, bytes)) {
      list.push_back(std::move(found));
    }
  }
}

SqlResult<std::int64_t> damaged_attachments(SqlDatabase& database) {
  const auto exists = database.has_table("attachments");
  if (!exists) return std::unexpected(exists.error());
  if (!*exists) return 0;
  auto rows = database.prepare("SELECT kind, name, bytes, crc FROM attachments");
  if (!rows) return std::unexpected(rows.error());
  std::int64_t damaged = 0;
  for (;;) {
    const auto row = rows->step();
    if (!row) return std::unexpected(row.error());
    if (!*row) return damaged;
    if (rows->integer(3) != checksum(rows->text(0), rows->text(1), rows->blob(2))) ++damaged;
  }
}

std::expected<std::map<ParticipantId, std::uint32_t>, JournalError> read_program_lines(
    const std::filesystem::path& journal) {
  auto database = open_journal(journal, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  const auto failed = [&](const SqlError& error) {
    return std::unexpected(to_journal_error(journal, error));
  };
  std::map<ParticipantId, std::uint32_t> lines;
  const auto exists = database->has_table("program_lines");
  if (!exists) return failed(exists.error());
  if (!*exists) return lines;
  auto rows = database->prepare("SELECT participant, line FROM program_lines");
  if (!rows) return failed(rows.error());
  for (;;) {
    const auto row = rows->step();
    if (!row) return failed(row.error());
    if (!*row) return lines;
    lines[static_cast<ParticipantId>(rows->integer(0))] =
        static_cast<std::uint32_t>(rows->integer(1));
  }
}

std::expected<void, JournalError> remove_attachments(const std::filesystem::path& journal) {
  auto database = SqlDatabase::open(journal, SqlMode::kWrite);
  if (!database) return std::unexpected(to_journal_error(journal, database.error()));
  const auto exists = database->has_table("attachments");
  if (!exists) return std::unexpected(to_journal_error(journal, exists.error()));
  if (!*exists) return {};
  // VACUUM drops the freed pages and with them their old contents.
  auto done = database->execute("DROP TABLE attachments; VACUUM");
  if (!done) return std::unexpected(to_journal_error(journal, done.error()));
  return {};
}

}  // namespace kerf
