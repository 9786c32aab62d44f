// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "server/store/byte_code.h"
#include "server/store/journal_change.h"
#include "server/store/journal_change_code.h"
#include "server/store/journal_file.h"
#include "server/store/journal_tables.h"
#include "server/store/record_rows.h"

namespace kerf {
namespace {

using Rows = std::vector<std::byte>;

void append(Rows& rows, std::span<const std::byte> bytes) {
  rows.insert(rows.end(), bytes.begin(), bytes.end());
}

void put_sized(ByteWriter& out, std::span<const std::byte> bytes) {
  out.put(static_cast<std::uint32_t>(bytes.size()));
  out.put(bytes);
}

void put_column(ByteWriter& out, const SqlStatement& row, int column, char type) {
  if (type == 'i') return out.put(static_cast<std::uint64_t>(row.integer(column)));
  if (type == 'b') return put_sized(out, row.blob(column));
  const std::string text = row.text(column);
  put_sized(out, std::as_bytes(std::span(text)));
}

Rows begin_row(const JournalTable& table, RowChange change) {
  return {std::byte{table.number}, static_cast<std::byte>(change)};
}

/// Encodes the current row of a query over all columns of a table as a kPut.
Rows encode_row(const JournalTable& table, const SqlStatement& row) {
  ByteWriter out;
  out.put(table.number);
  out.put(static_cast<std::uint8_t>(RowChange::kPut));
  for (std::size_t n = 0; n < table.columns.size(); ++n) {
    put_column(out, row, static_cast<int>(n), table.columns[n]);
  }
  return out.take();
}

std::string key_of(const JournalTable& table, const SqlStatement& row) {
  const std::string name = std::string(table.name) + '\n';
  if (table.key.empty()) return name;
  return name + (table.columns[0] == 'i' ? std::to_string(row.integer(0)) : row.text(0));
}

/// Encodes the removal of the row with a key from key_of().
Rows removal(const JournalTable& table, const std::string& key) {
  Rows rows = begin_row(table, RowChange::kRemove);
  ByteWriter out;
  const std::string text = key.substr(table.name.size() + 1);
  if (table.columns[0] == 'i') {
    out.put(static_cast<std::uint64_t>(std::stoll(text)));
  } else {
    put_sized(out, std::as_bytes(std::span(text)));
  }
  append(rows, out.take());
  return rows;
}

/// Calls `take` with each row of a query until it returns false.
template <typename Take>
SqlResult<void> for_each(SqlDatabase& database, const std::string& query, Take take) {
  auto rows = database.prepare(query);
  if (!rows) return std::unexpected(rows.error());
  for (;;) {
    const auto row = rows->step();
    if (!row) return std::unexpected(row.error());
    if (!*row || !take(*rows)) return {};
  }
}

SqlResult<void> read_origin(SqlDatabase& database, Rows& rows) {
  for (const JournalTable& table : kJournalTables) {
    if (table.kind != TableKind::kOrigin) continue;
    const auto exists = database.has_table(table.name);
    if (!exists) return std::unexpected(exists.error());
    if (!*exists) continue;
    append(rows, begin_row(table, RowChange::kClear));  // creates the table even if it has no rows
    const auto read = for_each(database, "SELECT * FROM " + std::string(table.name),
                               [&](const SqlStatement& row) {
                                 append(rows, encode_row(table, row));
                                 return true;
                               });
    if (!read) return read;
  }
  return {};
}

SqlResult<std::uint32_t> checksum_of_scene(SqlDatabase& database) {
  const auto crc = database.integer("SELECT crc FROM session");
  if (!crc) return std::unexpected(crc.error());
  return static_cast<std::uint32_t>(*crc);
}

/// Returns the checksum of the row that ends with this record; 0 if there is none.
SqlResult<std::uint32_t> checksum_of_record(SqlDatabase& database, std::uint64_t record) {
  const std::string last = std::to_string(record);
  std::uint32_t crc = 0;
  const auto note = [&](const SqlStatement& row) {
    crc = static_cast<std::uint32_t>(row.integer(0));
    return false;
  };
  // Search by the key: a batch has at most 65,536 records.
  auto read = for_each(database,
                       "SELECT crc FROM batches WHERE first<=" + last +
                           " AND first+count-1=" + last + " ORDER BY first DESC LIMIT 1",
                       note);
  if (!read) return std::unexpected(read.error());
  const auto is_old = database.has_table("commands");
  if (!is_old) return std::unexpected(is_old.error());
  if (crc == 0 && *is_old) {
    read = for_each(database, "SELECT crc FROM commands WHERE sequence=" + last, note);
    if (!read) return std::unexpected(read.error());
  }
  return crc;
}

const JournalTable& table_named(std::string_view name) {
  for (const JournalTable& table : kJournalTables) {
    if (table.name == name) return table;
  }
  std::unreachable();
}

/// Adds the batches after `after.record` and advances it. Returns false if it stopped at
/// kChangeBytes.
SqlResult<bool> read_batches(SqlDatabase& database, CopyPosition& after, Rows& rows) {
  static const JournalTable& table = table_named("batches");
  bool is_last = true;
  const std::size_t before = rows.size();
  const auto read = for_each(
      database,
      "SELECT * FROM batches WHERE first>" + std::to_string(after.record) + " ORDER BY first",
      [&](const SqlStatement& row) {
        is_last = rows.size() - before < kChangeBytes;
        if (!is_last) return false;
        append(rows, encode_row(table, row));
        after.record = static_cast<std::uint64_t>(row.integer(0) + row.integer(1) - 1);
        after.record_crc = static_cast<std::uint32_t>(row.integer(5));
        return true;
      });
  if (!read) return std::unexpected(read.error());
  return is_last;
}

/// Adds the state hashes from record `from` on for which the copy has the records.
SqlResult<void> read_hashes(SqlDatabase& database, std::uint64_t from, CopyPosition& after,
                            Rows& rows) {
  static const JournalTable& table = table_named("state_hashes");
  return for_each(database,
                  "SELECT * FROM state_hashes WHERE sequence>=" + std::to_string(from) +
                      " AND sequence<=" + std::to_string(after.record) + " ORDER BY sequence",
                  [&](const SqlStatement& row) {
                    append(rows, encode_row(table, row));
                    after.hash_after = static_cast<std::uint64_t>(row.integer(0));
                    return true;
                  });
}

/// Adds the changes of the small tables since `sent` and updates `sent`.
SqlResult<void> read_small(SqlDatabase& database, bool all, std::map<std::string, Rows>& sent,
                           Rows& rows) {
  std::map<std::string, Rows> now;
  for (const JournalTable& table : kJournalTables) {
    if (table.kind != TableKind::kSmall && table.kind != TableKind::kList) continue;
    if (all) append(rows, begin_row(table, RowChange::kClear));
    const auto exists = database.has_table(table.name);
    if (!exists) return std::unexpected(exists.error());
    if (!*exists) continue;
    const auto read = for_each(database, "SELECT * FROM " + std::string(table.name),
                               [&](const SqlStatement& row) {
                                 const std::string key = key_of(table, row);
                                 Rows bytes = encode_row(table, row);
                                 const auto old = sent.find(key);
                                 if (old == sent.end() || old->second != bytes) append(rows, bytes);
                                 now.emplace(key, std::move(bytes));
                                 return true;
                               });
    if (!read) return read;
    const std::string prefix = std::string(table.name) + '\n';
    for (auto old = sent.lower_bound(prefix); old != sent.end() && old->first.starts_with(prefix);
         ++old) {
      if (!now.contains(old->first)) append(rows, removal(table, old->first));
    }
  }
  sent = std::move(now);
  return {};
}

/// Adds the new and removed rows of a table of fixed rows since `sent`. Returns false if it stopped
/// at kChangeBytes.
SqlResult<bool> read_fixed(SqlDatabase& database, const JournalTable& table,
                           std::set<std::int64_t>& sent, Rows& rows) {
  const std::string name(table.name), key(table.key);
  const auto count = database.integer("SELECT count(*) FROM " + name);
  if (!count) return std::unexpected(count.error());
  const auto last = database.integer("SELECT coalesce(max(" + key + "),0) FROM " + name);
  if (!last) return std::unexpected(last.error());
  // A new row has a greater number than all earlier ones.
  const bool is_same = static_cast<std::size_t>(*count) == sent.size() &&
                       *last == (sent.empty() ? 0 : *sent.rbegin());
  if (is_same) return true;
  std::set<std::int64_t> now;
  auto read = for_each(database, "SELECT " + key + " FROM " + name, [&](const SqlStatement& row) {
    now.insert(row.integer(0));
    return true;
  });
  if (!read) return std::unexpected(read.error());
  std::erase_if(sent, [&](std::int64_t number) {
    const bool is_gone = !now.contains(number);
    if (is_gone) append(rows, removal(table, name + '\n' + std::to_string(number)));
    return is_gone;
  });
  const std::size_t before = rows.size();
  for (const std::int64_t number : now) {
    if (sent.contains(number)) continue;
    if (rows.size() - before >= kChangeBytes) return false;
    read =
        for_each(database, "SELECT * FROM " + name + " WHERE " + key + "=" + std::to_string(number),
                 [&](const SqlStatement& row) {
                   append(rows, encode_row(table, row));
                   return false;
                 });
    if (!read) return std::unexpected(read.error());
    sent.insert(number);
  }
  return true;
}

/// As above, for all such tables.
SqlResult<bool> read_all_fixed(SqlDatabase& database, bool all,
                               std::map<std::uint8_t, std::set<std::int64_t>>& sent, Rows& rows) {
  bool is_last = true;
  for (const JournalTable& table : kJournalTables) {
    if (table.kind != TableKind::kFixed) continue;
    if (all) append(rows, begin_row(table, RowChange::kClear));
    const auto exists = database.has_table(table.name);
    if (!exists) return std::unexpected(exists.error());
    if (!*exists) continue;
    const auto read = read_fixed(database, table, sent[table.number], rows);
    if (!read) return read;
    is_last = is_last && *read;
  }
  return is_last;
}

}  // namespace

std::expected<bool, JournalError> JournalChanges::begin(const CopyPosition& position) {
  position_ = position;
  is_first_ = true;
  sent_.clear();
  fixed_.clear();
  if (position.scene_crc == 0) return true;
  auto database = open_journal(file_, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  const auto scene = checksum_of_scene(*database);
  if (!scene) return std::unexpected(to_journal_error(file_, scene.error()));
  const auto record = checksum_of_record(*database, position.record);
  if (!record) return std::unexpected(to_journal_error(file_, record.error()));
  return *scene == position.scene_crc && *record == position.record_crc;
}

std::expected<CopyPosition, JournalError> end_of_journal(const std::filesystem::path& file) {
  auto database = open_journal(file, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  const auto scene = checksum_of_scene(*database);
  if (!scene) return std::unexpected(to_journal_error(file, scene.error()));
  const auto is_old = database->has_table("commands");
  if (!is_old) return std::unexpected(to_journal_error(file, is_old.error()));
  const std::string old = *is_old ? "(SELECT max(sequence) FROM commands)" : "0";
  const auto last =
      database->integer("SELECT coalesce((SELECT max(first+count-1) FROM batches)," + old + ",0)");
  if (!last) return std::unexpected(to_journal_error(file, last.error()));
  const auto record = static_cast<std::uint64_t>(*last);
  const auto crc = checksum_of_record(*database, record);
  if (!crc) return std::unexpected(to_journal_error(file, crc.error()));
  return CopyPosition{record, 0, *scene, *crc};
}

std::expected<std::uint32_t, JournalError> epoch_written(const std::filesystem::path& file) {
  auto database = open_journal(file, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  std::error_code error;
  if (std::filesystem::exists(file.string() + kCopiedSuffix, error)) return 0;
  const auto epoch = database->integer("SELECT epoch FROM session");
  if (!epoch) return std::unexpected(to_journal_error(file, epoch.error()));
  return static_cast<std::uint32_t>(*epoch);
}

std::expected<std::optional<JournalChange>, JournalError> JournalChanges::next() {
  auto database = open_journal(file_, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  return read(*database);
}

std::expected<std::optional<JournalChange>, JournalError> JournalChanges::read(
    SqlDatabase& database) {
  const auto failed = [&](const SqlError& error) {
    return std::unexpected(to_journal_error(file_, error));
  };
  // Read in one transaction to get a consistent state.
  if (auto ok = database.execute("BEGIN"); !ok) return failed(ok.error());
  JournalChange change;
  change.before = change.after = position_;
  Rows& rows = change.rows;
  if (position_.scene_crc == 0) {
    if (auto ok = read_origin(database, rows); !ok) return failed(ok.error());
    const auto scene = checksum_of_scene(database);
    if (!scene) return failed(scene.error());
    change.after.scene_crc = *scene;
    const auto is_old = database.has_table("commands");
    if (!is_old) return failed(is_old.error());
    if (*is_old) {
      const auto last = database.integer("SELECT coalesce(max(sequence),0) FROM commands");
      if (!last) return failed(last.error());
      change.after.record = static_cast<std::uint64_t>(*last);
      const auto crc = checksum_of_record(database, change.after.record);
      if (!crc) return failed(crc.error());
      change.after.record_crc = *crc;
    }
  }
  const auto is_last = read_batches(database, change.after, rows);
  if (!is_last) return failed(is_last.error());
  change.is_whole = *is_last;
  // When the journal was opened, a hash of another kernel may have replaced the newest one.
  const std::uint64_t from = position_.hash_after + (is_first_ ? 0 : 1);
  if (auto ok = read_hashes(database, from, change.after, rows); !ok) return failed(ok.error());
  // Send these only with a whole change: they may refer to records still to come.
  if (change.is_whole) {
    if (auto ok = read_small(database, is_first_, sent_, rows); !ok) return failed(ok.error());
    const auto is_all = read_all_fixed(database, is_first_, fixed_, rows);
    if (!is_all) return failed(is_all.error());
    change.is_whole = *is_all;
    is_first_ = false;
  }
  position_ = change.after;
  if (rows.empty()) return std::nullopt;
  return change;
}

}  // namespace kerf
