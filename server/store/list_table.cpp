// SPDX-License-Identifier: Apache-2.0
#include "server/store/list_table.h"

#include <algorithm>
#include <functional>
#include <span>
#include <utility>

#include "server/store/crc32.h"

namespace kerf {
namespace {

/// Checksum over the texts, each with its terminating zero, then over the integers.
std::int64_t checksum(const ListRow& row) {
  std::uint32_t crc = 0;
  for (const ListValue& value : row) {
    if (const auto* text = std::get_if<std::string>(&value)) {
      crc = crc32(std::as_bytes(std::span(text->c_str(), text->size() + 1)), crc);
    }
  }
  for (const ListValue& value : row) {
    if (const auto* number = std::get_if<std::int64_t>(&value)) {
      crc = crc32(std::as_bytes(std::span(number, 1)), crc);
    }
  }
  return crc;
}

void bind(SqlStatement& statement, int column, const ListValue& value) {
  std::visit([&](const auto& one) { statement.bind(column, one); }, value);
}

SqlResult<void> delete_row(SqlDatabase& database, const JournalTable& table, const ListValue& key) {
  auto statement = database.prepare("DELETE FROM " + std::string(table.name) + " WHERE " +
                                    std::string(table.key) + "=?");
  if (!statement) return std::unexpected(statement.error());
  bind(*statement, 1, key);
  return statement->run();
}

SqlResult<void> store_row(SqlDatabase& database, const JournalTable& table, const ListRow& row) {
  std::string sql = "INSERT OR REPLACE INTO " + std::string(table.name) + " VALUES(";
  for (std::size_t n = 0; n < row.size(); ++n) sql += "?,";
  auto statement = database.prepare(sql + "?)");
  if (!statement) return std::unexpected(statement.error());
  int column = 0;
  for (const ListValue& value : row) bind(*statement, ++column, value);
  statement->bind(++column, checksum(row));
  return statement->run();
}

/// Reads the columns of a row without its checksum.
ListRow row_of(const SqlStatement& rows, std::string_view columns) {
  ListRow row;
  for (const char type : columns.substr(0, columns.size() - 1)) {
    const int column = static_cast<int>(row.size());
    if (type == 'i') row.emplace_back(rows.integer(column));
    if (type == 't') row.emplace_back(rows.text(column));
  }
  return row;
}

/// Calls `visit` with each row of a table, if it exists, by its key, and whether the checksum
/// holds.
SqlResult<void> each_row(SqlDatabase& database, const JournalTable& table,
                         const std::function<void(ListRow row, bool is_good)>& visit) {
  const auto exists = database.has_table(table.name);
  if (!exists) return std::unexpected(exists.error());
  if (!*exists) return {};
  auto rows = database.prepare("SELECT * FROM " + std::string(table.name) + " ORDER BY " +
                               std::string(table.key));
  if (!rows) return std::unexpected(rows.error());
  for (;;) {
    const auto row = rows->step();
    if (!row) return std::unexpected(row.error());
    if (!*row) return {};
    ListRow one = row_of(*rows, table.columns);
    const bool is_good = rows->integer(static_cast<int>(one.size())) == checksum(one);
    visit(std::move(one), is_good);
  }
}

}  // namespace

std::uint64_t record_of(const JournalTable& table, const ListRow& row) {
  return static_cast<std::uint64_t>(std::get<std::int64_t>(row.at(table.record_column)));
}

SqlResult<void> create_list_tables(SqlDatabase& database) {
  for (const JournalTable& table : kJournalTables) {
    if (table.kind != TableKind::kList) continue;
    if (auto ok = database.execute(std::string(table.create)); !ok) return ok;
  }
  return {};
}

SqlResult<void> store_list_change(SqlDatabase& database, const ListChange& change) {
  const JournalTable& table = *std::ranges::find(kJournalTables, change.table, &JournalTable::name);
  if (change.removed) {
    if (auto ok = delete_row(database, table, *change.removed); !ok) return ok;
  }
  return change.stored ? store_row(database, table, *change.stored) : SqlResult<void>();
}

SqlResult<Lists> read_lists(SqlDatabase& database, std::uint64_t last) {
  Lists lists;
  for (const JournalTable& table : kJournalTables) {
    if (table.kind != TableKind::kList) continue;
    std::vector<ListRow> list;
    const auto read = each_row(database, table, [&](ListRow row, bool is_good) {
      if (is_good && record_of(table, row) <= last) list.push_back(std::move(row));
    });
    if (!read) return std::unexpected(read.error());
    lists.emplace(table.name, std::move(list));
  }
  return lists;
}

SqlResult<std::map<std::string, std::int64_t>> damaged_list_rows(SqlDatabase& database) {
  std::map<std::string, std::int64_t> damaged;
  for (const JournalTable& table : kJournalTables) {
    if (table.kind != TableKind::kList) continue;
    const auto read = each_row(database, table, [&](const ListRow&, bool is_good) {
      if (!is_good) ++damaged[std::string(table.name)];
    });
    if (!read) return std::unexpected(read.error());
  }
  return damaged;
}

}  // namespace kerf
