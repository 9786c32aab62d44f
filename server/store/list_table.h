// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/store/sqlite.h"

namespace kerf {

/// A row of a list that people keep with a block (TableKind::kList): its columns without the
/// checksum. The first one is the key, the second one the number of a record.
using ListValue = std::variant<std::int64_t, std::string>;
using ListRow = std::vector<ListValue>;
/// Rows by the name of their table, each table ordered by its key.
using Lists = std::map<std::string, std::vector<ListRow>, std::less<>>;

/// A change of one list, stored in one transaction. A renamed row has both a removed key and a
/// stored row.
struct ListChange {
  std::string_view table;                           ///< a name in kJournalTables
  std::optional<ListValue> removed = std::nullopt;  ///< key of the row that is deleted
  std::optional<ListRow> stored = std::nullopt;     ///< inserted, or replaces the row of its key
};

/// Number of the record that a row states.
std::uint64_t record_of(const ListRow& row);

/// Creates the tables of all lists that the journal lacks.
SqlResult<void> create_list_tables(SqlDatabase& database);
/// To be called in a transaction.
SqlResult<void> store_list_change(SqlDatabase& database, const ListChange& change);
/// Returns the rows of all lists up to record `last`. Omits rows whose checksum is wrong. A table
/// that does not exist has no rows.
SqlResult<Lists> read_lists(SqlDatabase& database, std::uint64_t last);

}  // namespace kerf
