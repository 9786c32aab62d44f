// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <utility>

#include "server/store/byte_code.h"
#include "server/store/journal_change.h"
#include "server/store/journal_change_code.h"
#include "server/store/journal_file.h"
#include "server/store/journal_reader.h"
#include "server/store/journal_tables.h"

namespace kerf {
namespace {

/// One decoded row of a change.
struct RowCode {
  const JournalTable* table = nullptr;
  RowChange change = RowChange::kPut;
  std::vector<std::int64_t> integers;             ///< by column
  std::vector<std::span<const std::byte>> bytes;  ///< by column
};

/// Reads the next row; nullopt if the bytes are malformed.
std::optional<RowCode> next_row(ByteReader& in) {
  RowCode row;
  const auto number = in.get<std::uint8_t>();
  const auto table = std::ranges::find(kJournalTables, number, &JournalTable::number);
  if (table == kJournalTables.end()) return std::nullopt;
  row.table = &*table;
  row.change = static_cast<RowChange>(in.get<std::uint8_t>());
  std::size_t columns = 0;
  if (row.change == RowChange::kPut) columns = table->columns.size();
  if (row.change == RowChange::kRemove && !table->key.empty()) columns = 1;
  if (columns == 0 && row.change != RowChange::kClear) return std::nullopt;
  row.integers.resize(columns);
  row.bytes.resize(columns);
  for (std::size_t n = 0; n < columns; ++n) {
    if (table->columns[n] == 'i') {
      row.integers[n] = static_cast<std::int64_t>(in.get<std::uint64_t>());
    } else {
      row.bytes[n] = in.get_bytes(in.get<std::uint32_t>());
    }
  }
  if (in.truncated()) return std::nullopt;
  return row;
}

std::string statement_of(const RowCode& row) {
  const std::string name(row.table->name);
  if (row.change == RowChange::kRemove) {
    return "DELETE FROM " + name + " WHERE " + std::string(row.table->key) + "=?";
  }
  std::string text = "INSERT OR REPLACE INTO " + name + " VALUES(?";
  for (std::size_t n = 1; n < row.table->columns.size(); ++n) text += ",?";
  return text + ")";
}

SqlResult<void> write_row(SqlDatabase& database, const RowCode& row) {
  if (row.change == RowChange::kClear) {
    const std::string create(row.table->create);
    return database.execute(create + ";DELETE FROM " + std::string(row.table->name));
  }
  if (row.change == RowChange::kPut && row.table->key.empty()) {  // the table has a single row
    if (auto ok = database.execute("DELETE FROM " + std::string(row.table->name)); !ok) return ok;
  }
  auto statement = database.prepare(statement_of(row));
  if (!statement) return std::unexpected(statement.error());
  for (std::size_t n = 0; n < row.bytes.size(); ++n) {
    const int parameter = static_cast<int>(n) + 1;
    const auto bytes = row.bytes[n];
    const char type = row.table->columns[n];
    if (type == 'i') statement->bind(parameter, row.integers[n]);
    if (type == 'b') statement->bind(parameter, bytes);
    if (type == 't') {
      statement->bind(parameter,
                      std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    }
  }
  if (const auto done = statement->step(); !done) return std::unexpected(done.error());
  return {};
}

std::expected<void, JournalError> mark_copied(const std::filesystem::path& file) {
  const std::filesystem::path mark = file.string() + kCopiedSuffix;
  if (std::ofstream(mark)) return {};
  return std::unexpected(
      JournalError{JournalErrorCode::kIo, mark.string(), 0, "the file cannot be created"});
}

/// Reads a journal from its first to its last record.
std::expected<void, JournalError> verify(const std::filesystem::path& file) {
  auto reader = JournalReader::open(file);
  if (!reader) return std::unexpected(reader.error());
  for (;;) {
    const auto record = reader->next();
    if (!record) return std::unexpected(record.error());
    if (!*record) return {};
  }
}

}  // namespace

JournalCopy::JournalCopy(std::filesystem::path file, std::filesystem::path unfinished,
                         SqlDatabase database)
    : file_(std::move(file)), unfinished_(std::move(unfinished)), database_(std::move(database)) {}

JournalCopy::~JournalCopy() {
  database_.reset();
  if (!unfinished_.empty()) remove_journal(unfinished_);
}

JournalError JournalCopy::corrupt(std::string reason) const {
  return {JournalErrorCode::kCorrupt, file_.string(), 0, std::move(reason)};
}

std::expected<JournalCopy, JournalError> JournalCopy::create(const std::filesystem::path& file) {
  const auto unfinished = unfinished_journal(file);
  if (!unfinished) return std::unexpected(unfinished.error());
  auto database = create_journal(*unfinished, {});
  if (!database) return std::unexpected(database.error());
  // Drop the initial rows: those of the copied journal replace them. A savepoint follows each whole
  // change.
  auto empty =
      database->execute("BEGIN;DELETE FROM session;DELETE FROM kernel_versions;SAVEPOINT whole");
  if (!empty) return std::unexpected(to_journal_error(file, empty.error()));
  return JournalCopy(file, *unfinished, *std::move(database));
}

std::expected<JournalCopy, JournalError> JournalCopy::resume(const std::filesystem::path& file,
                                                             const CopyPosition& position) {
  // Do not use open_journal(): the copy keeps the epoch of its journal.
  auto database = SqlDatabase::open(file, SqlMode::kWrite);
  if (!database) return std::unexpected(to_journal_error(file, database.error()));
  // Changes lost in a crash are copied again.
  if (auto ok = mark_copied(file); !ok) return std::unexpected(ok.error());
  auto begun = database->execute("PRAGMA synchronous=NORMAL;BEGIN;SAVEPOINT whole");
  if (!begun) return std::unexpected(to_journal_error(file, begun.error()));
  JournalCopy copy(file, {}, *std::move(database));
  copy.position_ = position;
  copy.whole_ = position;
  return copy;
}

std::expected<void, JournalError> JournalCopy::apply(const JournalChange& change) {
  if (change.before != position_ && change.before == whole_) {
    if (auto ok = database_->execute("ROLLBACK TO whole"); !ok) {
      return std::unexpected(to_journal_error(file_, ok.error()));
    }
    position_ = *whole_;
  }
  if (change.before != position_) {
    return std::unexpected(corrupt("the changes from record " +
                                   std::to_string(change.before.record) +
                                   " on do not follow record " + std::to_string(position_.record)));
  }
  ByteReader in(change.rows);
  while (!in.at_end()) {
    const auto row = next_row(in);
    if (!row) return std::unexpected(corrupt("a change has rows of an unknown format"));
    if (auto ok = write_row(*database_, *row); !ok) {
      return std::unexpected(to_journal_error(file_, ok.error()));
    }
    lists_changed_ = lists_changed_ || row->table->kind == TableKind::kList;
    attachments_changed_ = attachments_changed_ || row->table->name == "attachments";
  }
  position_ = change.after;
  if (!change.is_whole) return {};
  whole_ = position_;
  const bool is_finished = unfinished_.empty();
  const std::string end = is_finished ? "RELEASE whole;COMMIT;BEGIN;" : "RELEASE whole;";
  if (auto ok = database_->execute(end + "SAVEPOINT whole"); !ok) {
    return std::unexpected(to_journal_error(file_, ok.error()));
  }
  return {};
}

std::expected<CopyPosition, JournalError> JournalCopy::finish() {
  if (!whole_) return std::unexpected(corrupt("the copy is not complete"));
  if (auto ok = database_->execute("ROLLBACK TO whole;COMMIT"); !ok) {
    return std::unexpected(to_journal_error(file_, ok.error()));
  }
  database_.reset();  // empties and removes the write-ahead log
  if (auto good = verify(unfinished_); !good) return std::unexpected(good.error());
  if (auto ok = mark_copied(file_); !ok) return std::unexpected(ok.error());
  if (const auto error = rename_new(unfinished_, file_)) {
    const auto code =
        error == std::errc::file_exists ? JournalErrorCode::kExists : JournalErrorCode::kIo;
    return std::unexpected(JournalError{code, file_.string(), 0, error.message()});
  }
  unfinished_.clear();
  return *whole_;
}

}  // namespace kerf
