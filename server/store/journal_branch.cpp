// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_branch.h"

#include <algorithm>
#include <array>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "server/store/batch_insert.h"
#include "server/store/chunk_file.h"
#include "server/store/crc32.h"
#include "server/store/journal_base.h"
#include "server/store/journal_file.h"
#include "server/store/journal_reader.h"
#include "server/store/list_table.h"
#include "server/store/record_batch.h"
#include "server/store/record_origins.h"
#include "server/store/record_rows.h"
#include "server/store/table_copy.h"

namespace kerf {
namespace {

std::int64_t checksum(const JournalParent& parent) {
  const std::array numbers = {static_cast<std::int64_t>(parent.record), std::int64_t{parent.epoch},
                              parent.branched_ms};
  return crc32(std::as_bytes(std::span(numbers)), crc32(std::as_bytes(std::span(parent.session))));
}

SqlResult<void> store_parent(SqlDatabase& database, const JournalParent& parent) {
  if (auto ok = database.execute("CREATE TABLE parent(session TEXT NOT NULL, record INTEGER NOT "
                                 "NULL, epoch INTEGER NOT NULL, branched_ms INTEGER NOT NULL, crc "
                                 "INTEGER NOT NULL)");
      !ok) {
    return ok;
  }
  auto insert = database.prepare("INSERT INTO parent VALUES(?,?,?,?,?)");
  if (!insert) return std::unexpected(insert.error());
  insert->bind(1, parent.session);
  insert->bind(2, static_cast<std::int64_t>(parent.record));
  insert->bind(3, std::int64_t{parent.epoch});
  insert->bind(4, parent.branched_ms);
  insert->bind(5, checksum(parent));
  if (auto row = insert->step(); !row) return std::unexpected(row.error());
  return {};
}

/// Copies all whole rows, i.e. everything but the batch with records before and after the branch.
SqlResult<void> copy_tables(SqlDatabase& from, SqlDatabase& to, std::uint64_t last) {
  const std::string up_to_last = "<=" + std::to_string(last);
  const std::pair<const char*, std::string> tables[] = {
      {"participants", ""},
      {"kernel_versions", "sequence" + up_to_last},
      {"state_hashes", "sequence" + up_to_last},
      {"commands", "sequence" + up_to_last},
      {"batches", "first+count-1" + up_to_last}};
  for (const auto& [name, where] : tables) {
    if (auto ok = copy_table(from, to, name, where); !ok) return ok;
  }
  const auto lists = read_lists(from, last);
  if (!lists) return std::unexpected(lists.error());
  for (const auto& [table, rows] : *lists) {
    if (table == kOriginsTable) continue;
    for (const ListRow& row : rows) {
      if (auto ok = store_list_change(to, {.table = table, .stored = row}); !ok) return ok;
    }
  }
  return {};
}

/// Stores the origins of all records, also of those for which `journal` stores none: the branch is
/// another session.
SqlResult<void> store_origins(const JournalReader& journal, SqlDatabase& to, std::uint64_t last) {
  const RecordOrigins origins(journal.header().session, journal.parent(),
                              journal.lists().at(std::string(kOriginsTable)), last);
  for (const OriginRow& row : origins.rows()) {
    if (auto ok = store_list_change(to, {.table = kOriginsTable, .stored = to_row(row)}); !ok)
      return ok;
  }
  return {};
}

/// Writes the records of `from` after the last whole batch of `to`, up to `last`, as one batch.
std::expected<void, JournalError> copy_rest(const std::filesystem::path& file, SqlDatabase& from,
                                            SqlDatabase& to, std::uint64_t last) {
  const auto failed = [&](const SqlError& error) {
    return std::unexpected(to_journal_error(file, error));
  };
  const auto base = base_record(to);
  if (!base) return failed(base.error());
  const auto whole = last_record(to);
  if (!whole) return failed(whole.error());
  const std::uint64_t copied = std::max(*base, *whole);
  if (copied >= last) return {};
  auto rows = RecordRows::open(file, from, copied + 1);
  if (!rows) return std::unexpected(rows.error());
  std::vector<BatchRecord> records;
  BatchHead head{copied + 1};
  while (copied + records.size() < last) {
    auto record = rows->next();
    if (!record) return std::unexpected(record.error());
    if (!*record) {
      return std::unexpected(
          JournalError{JournalErrorCode::kIo, file.string(), last, "the record is not there yet"});
    }
    JournalRecord& next = **record;
    if (records.empty()) head.wall_ms = next.wall_ms;
    head.span_ms = std::clamp(next.wall_ms - head.wall_ms, std::int64_t{0}, kSpanMaxMs);
    const bool begins_stroke = next.stroke == next.sequence;
    records.push_back({next.participant, std::move(next.command), begins_stroke});
  }
  head.count = records.size();
  const std::vector<std::byte> bytes = BatchEncoder().encode(records);
  auto insert = prepare_batch_insert(to);
  if (!insert) return failed(insert.error());
  if (auto ok = insert_batch(*insert, head, bytes); !ok) return failed(ok.error());
  return {};
}

std::expected<void, JournalError> fill(const std::filesystem::path& from,
                                       const JournalReader& journal, SqlDatabase& to,
                                       const JournalParent& parent) {
  auto source = open_journal(from, SqlMode::kRead);
  if (!source) return std::unexpected(source.error());
  const auto done = [&](const SqlResult<void>& result) -> std::expected<void, JournalError> {
    if (result) return {};
    return std::unexpected(to_journal_error(from, result.error()));
  };
  // One read transaction for all reads, one write transaction for all writes.
  if (auto ok = done(source->execute("BEGIN")); !ok) return ok;
  // The copied rows bring the versions of the kernel that computed the hashes.
  if (auto ok = done(to.execute("BEGIN;DELETE FROM kernel_versions")); !ok) return ok;
  if (auto ok = done(store_parent(to, parent)); !ok) return ok;
  if (auto ok = done(copy_tables(*source, to, parent.record)); !ok) return ok;
  if (auto ok = done(store_origins(journal, to, parent.record)); !ok) return ok;
  if (auto ok = copy_rest(from, *source, to, parent.record); !ok) return ok;
  return done(to.execute("COMMIT; PRAGMA journal_mode=WAL"));
}

std::expected<void, JournalError> rename_branch(const std::filesystem::path& copy,
                                                const std::filesystem::path& to) {
  using enum JournalErrorCode;
  const std::error_code error = rename_new(copy, to);
  if (!error) return {};
  const auto code = error == std::errc::file_exists ? kExists : kIo;
  return std::unexpected(JournalError{code, to.string(), 0, error.message()});
}

/// Writes the copy and closes it.
std::expected<void, JournalError> write_branch(const std::filesystem::path& from,
                                               const std::filesystem::path& copy,
                                               const JournalReader& journal,
                                               const JournalHeader& header,
                                               const JournalParent& parent) {
  auto database = create_journal(copy, header, CreateMode::kCopy);
  if (!database) return std::unexpected(database.error());
  return fill(from, journal, *database, parent);
}

}  // namespace

std::expected<void, JournalError> branch_journal(const std::filesystem::path& from,
                                                 const std::filesystem::path& to,
                                                 const std::string& session,
                                                 const JournalParent& parent) {
  const auto reader = JournalReader::open(from);
  if (!reader) return std::unexpected(reader.error());
  JournalHeader header = reader->header();
  header.session = session;
  const std::filesystem::path copy = unfinished_file(to);
  remove_journal(copy);  // possibly left by a crash
  try {
    auto written = write_branch(from, copy, *reader, header, parent);
    if (written) written = rename_branch(copy, to);
    if (!written) remove_journal(copy);
    return written;
  } catch (...) {  // e.g. not enough memory
    remove_journal(copy);
    throw;
  }
}

bool is_unfinished_branch(const std::filesystem::path& file) {
  const std::filesystem::path journal = file.parent_path() / file.stem();
  return journal.extension() == kJournalExtension && file == unfinished_file(journal);
}

SqlResult<JournalParent> read_parent(SqlDatabase& database) {
  const auto exists = database.has_table("parent");
  if (!exists) return std::unexpected(exists.error());
  if (!*exists) return JournalParent{};
  auto rows = database.prepare("SELECT session, record, epoch, branched_ms, crc FROM parent");
  if (!rows) return std::unexpected(rows.error());
  const auto row = rows->step();
  if (!row) return std::unexpected(row.error());
  if (!*row) return JournalParent{};
  JournalParent parent{rows->text(0), static_cast<std::uint64_t>(rows->integer(1)),
                       static_cast<std::uint32_t>(rows->integer(2)), rows->integer(3)};
  return rows->integer(4) == checksum(parent) ? parent : JournalParent{};
}

}  // namespace kerf
