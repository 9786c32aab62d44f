// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/store/journal_tables.h"
#include "server/store/sqlite.h"

namespace kerf {

/// A row of a list that people keep with a block (TableKind::kList): its columns without the
/// checksum. The first one is the key; one of them is a record number (JournalTable).
using ListValue = std::variant<std::int64_t, std::string>;
using ListRow = std::vector<ListValue>;
/// Rows by the name of their table, each table ordered by its key.
using Lists = std::map<std::string, std::vector<ListRow>, std::less<>>;

/// A change of one list, stored in one transaction. A renamed row has both a removed key and a
/// stored row.
struct ListChange {
  std::string_view table;                           ///< a name in kJournalTables
  std::optional<ListValue> removed = std::nullopt;  ///< key of the row to delete
  std::optional<ListRow> stored = std::nullopt;     ///< replaces the row with its key, if any
};

/// Returns the record number of a row of a table.
std::uint64_t record_of(const JournalTable& table, const ListRow& row);

/// Creates missing tables of lists.
SqlResult<void> create_list_tables(SqlDatabase& database);
/// Call it in a transaction.
SqlResult<void> store_list_change(SqlDatabase& database, const ListChange& change);
/// Returns the rows of all lists up to record `last`, without rows whose checksum is wrong. A
/// missing table has no rows.
SqlResult<Lists> read_lists(SqlDatabase& database, std::uint64_t last);
/// Returns the number of rows with a wrong checksum by table, whichever record they name.
SqlResult<std::map<std::string, std::int64_t>> damaged_list_rows(SqlDatabase& database);

}  // namespace kerf
