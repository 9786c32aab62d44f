// SPDX-License-Identifier: Apache-2.0
#include "server/store/record_rows.h"

#include <algorithm>
#include <utility>

#include "server/store/journal_base.h"
#include "server/store/journal_file.h"

namespace kerf {
namespace {

/// Prepares a query of a table; empty if the table does not exist.
SqlResult<std::optional<SqlStatement>> prepare_if(SqlDatabase& database, const std::string& table,
                                                  const std::string& query) {
  const auto exists = database.has_table(table);
  if (!exists) return std::unexpected(exists.error());
  if (!*exists) return std::optional<SqlStatement>();
  auto statement = database.prepare(query);
  if (!statement) return std::unexpected(statement.error());
  return std::optional(*std::move(statement));
}

}  // namespace

SqlResult<std::int64_t> restart_before(SqlDatabase& database, std::uint64_t from) {
  if (from <= 1) return 0;
  auto rows =
      prepare_if(database, "batches",
                 "SELECT first, count, bytes FROM batches WHERE first<=? ORDER BY first DESC");
  if (!rows) return std::unexpected(rows.error());
  if (!*rows) return 0;
  (*rows)->bind(1, static_cast<std::int64_t>(from));
  for (;;) {
    const auto row = (*rows)->step();
    if (!row) return std::unexpected(row.error());
    if (!*row) return 0;
    if (restarts((*rows)->blob(2))) return (*rows)->integer(0);
  }
}

BatchRow batch_of(const SqlStatement& row) {
  return {{static_cast<std::uint64_t>(row.integer(0)), static_cast<std::uint64_t>(row.integer(1)),
           row.integer(2), row.integer(3)},
          row.integer(5),
          row.blob(4)};
}

SqlResult<std::uint64_t> last_record(SqlDatabase& database) {
  std::int64_t last = 0;
  const std::pair<const char*, const char*> queries[] = {
      {"commands", "SELECT coalesce(max(sequence),0) FROM commands"},
      {"batches",
       "SELECT coalesce((SELECT first+count-1 FROM batches ORDER BY first DESC LIMIT 1),0)"}};
  for (const auto& [table, query] : queries) {
    const auto exists = database.has_table(table);
    if (!exists) return std::unexpected(exists.error());
    if (!*exists) continue;
    const auto found = database.integer(query);
    if (!found) return std::unexpected(found.error());
    last = std::max(last, *found);
  }
  return static_cast<std::uint64_t>(last);
}

std::expected<RecordRows, JournalError> RecordRows::open(const std::filesystem::path& file,
                                                         SqlDatabase& database,
                                                         std::uint64_t from) {
  RecordRows rows(file);
  if (auto ok = rows.prepare(database, from); !ok) {
    return std::unexpected(to_journal_error(file, ok.error()));
  }
  return rows;
}

SqlResult<void> RecordRows::prepare(SqlDatabase& database, std::uint64_t from) {
  const auto base = base_record(database);
  if (!base) return std::unexpected(base.error());
  from = std::max(from, *base + 1);
  from_ = from;
  const auto last = last_record(database);
  if (!last) return std::unexpected(last.error());
  last_ = *last;
  const auto start = restart_before(database, from);
  if (!start) return std::unexpected(start.error());
  if (from > 1) count_ = (*start > 0 ? static_cast<std::uint64_t>(*start) : from) - 1;
  auto singles =
      prepare_if(database, "commands",
                 "SELECT sequence, participant, bytes, crc FROM commands WHERE sequence>" +
                     std::to_string(count_) + " ORDER BY sequence");
  if (!singles) return std::unexpected(singles.error());
  auto batches =
      prepare_if(database, "batches",
                 "SELECT first, count, wall_ms, span_ms, bytes, crc FROM batches WHERE first>=" +
                     std::to_string(*start) + " ORDER BY first");
  if (!batches) return std::unexpected(batches.error());
  singles_ = *std::move(singles);
  batches_ = *std::move(batches);
  return {};
}

JournalError RecordRows::corrupt(std::uint64_t sequence, std::string reason) const {
  return {JournalErrorCode::kCorrupt, file_.string(), sequence, std::move(reason)};
}

std::expected<bool, JournalError> RecordRows::step(SqlStatement& rows) const {
  const auto row = rows.step();
  if (row) return *row;
  auto error = to_journal_error(file_, row.error());
  error.sequence = count_ + 1;
  return std::unexpected(error);
}

std::expected<std::optional<JournalRecord>, JournalError> RecordRows::next() {
  for (;;) {
    auto record = next_of_all();
    if (!record || !*record || (*record)->sequence >= from_) return record;
  }
}

std::expected<std::optional<JournalRecord>, JournalError> RecordRows::next_of_all() {
  if (singles_) {
    auto record = next_single();
    if (!record || *record) return record;
    singles_.reset();
  }
  while (at_ == batch_.size()) {
    const auto more = batches_ ? next_batch() : false;
    if (!more) return std::unexpected(more.error());
    if (*more) continue;
    batches_.reset();
    if (count_ == last_) return std::nullopt;
    return std::unexpected(corrupt(0, std::to_string(last_ - count_) + " records are missing"));
  }
  return std::move(batch_[at_++]);
}

std::expected<std::optional<JournalRecord>, JournalError> RecordRows::next_single() {
  const auto row = step(*singles_);
  if (!row) return std::unexpected(row.error());
  if (!*row) return std::nullopt;
  JournalRecord record;
  record.sequence = static_cast<std::uint64_t>(singles_->integer(0));
  if (record.sequence != count_ + 1) {
    return std::unexpected(corrupt(
        count_ + 1, "the record is missing: the next one is " + std::to_string(record.sequence)));
  }
  record.participant = static_cast<ParticipantId>(singles_->integer(1));
  const auto bytes = singles_->blob(2);
  if (singles_->integer(3) !=
      std::int64_t{record_checksum(record.sequence, record.participant, bytes)}) {
    return std::unexpected(corrupt(record.sequence, "the checksum of the record is wrong"));
  }
  auto command = decode_command(bytes);
  if (!command) return std::unexpected(corrupt(record.sequence, command.error()));
  record.command = *std::move(command);
  ++count_;
  return record;
}

/// Decodes the next batch. Returns false if there is none.
std::expected<bool, JournalError> RecordRows::next_batch() {
  const auto row = step(*batches_);
  if (!row || !*row) return row;
  auto records = rows_.read(batch_of(*batches_), count_);
  if (!records) {
    return std::unexpected(corrupt(records.error().sequence, std::move(records.error().reason)));
  }
  batch_ = *std::move(records);
  at_ = 0;
  count_ += batch_.size();
  return true;
}

std::expected<SortedRecords, JournalError> SortedRecords::sort(RecordRows& rows,
                                                               const std::filesystem::path& file,
                                                               const std::stop_token& stop) {
  const auto failed = [&](const SqlError& error) {
    return std::unexpected(JournalError{JournalErrorCode::kIo, file.string(), 0,
                                        "cannot sort the records: " + error.reason});
  };
  auto database = SqlDatabase::open({}, SqlMode::kCreate);  // SQLite's temporary database
  if (!database) return failed(database.error());
  if (stop.stop_possible()) database->end_on(stop);
  if (auto ok = database->execute(
          "PRAGMA journal_mode=OFF;PRAGMA synchronous=OFF;BEGIN;CREATE TABLE records(participant "
          "INTEGER,sequence INTEGER,wall_ms INTEGER,stroke INTEGER,bytes BLOB,PRIMARY "
          "KEY(participant,"
          "sequence)) WITHOUT ROWID");
      !ok) {
    return failed(ok.error());
  }
  {
    auto insert = database->prepare("INSERT INTO records VALUES(?,?,?,?,?)");
    if (!insert) return failed(insert.error());
    for (;;) {
      if (stop.stop_requested()) return failed({0, "stopped"});
      auto record = rows.next();
      if (!record) return std::unexpected(record.error());
      if (!*record) break;
      insert->bind(1, std::int64_t{(*record)->participant});
      insert->bind(2, static_cast<std::int64_t>((*record)->sequence));
      insert->bind(3, (*record)->wall_ms);
      insert->bind(4, static_cast<std::int64_t>((*record)->stroke));
      insert->bind(5, std::span<const std::byte>(encode_command((*record)->command)));
      if (auto row = insert->step(); !row) return failed(row.error());
    }
  }
  auto sorted = database->prepare(
      "SELECT participant, sequence, wall_ms, stroke, bytes FROM records "
      "ORDER BY participant, sequence");
  if (!sorted) return failed(sorted.error());
  return SortedRecords(file, *std::move(database), *std::move(sorted));
}

std::expected<std::optional<JournalRecord>, JournalError> SortedRecords::next() {
  const auto row = rows_.step();
  if (!row) return std::unexpected(to_journal_error(file_, row.error()));
  if (!*row) return std::nullopt;
  auto command = decode_command(rows_.blob(4));
  if (!command) {
    return std::unexpected(
        JournalError{JournalErrorCode::kIo, file_.string(), 0, "cannot sort the records"});
  }
  return JournalRecord{static_cast<std::uint64_t>(rows_.integer(1)),
                       static_cast<ParticipantId>(rows_.integer(0)), *std::move(command),
                       rows_.integer(2), static_cast<std::uint64_t>(rows_.integer(3))};
}

}  // namespace kerf
