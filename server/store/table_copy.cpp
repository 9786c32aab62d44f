// SPDX-License-Identifier: Apache-2.0
#include "server/store/table_copy.h"

#include <algorithm>

#include "server/store/journal_tables.h"

namespace kerf {

SqlResult<void> copy_table(SqlDatabase& from, SqlDatabase& to, std::string_view name,
                           const std::string& where) {
  const JournalTable& table = *std::ranges::find(kJournalTables, name, &JournalTable::name);
  const auto exists = from.has_table(name);
  if (!exists) return std::unexpected(exists.error());
  if (!*exists) return {};
  if (auto ok = to.execute(std::string(table.create)); !ok) return ok;
  const std::string whole = "SELECT * FROM " + std::string(name);
  auto rows = from.prepare(where.empty() ? whole : whole + " WHERE " + where);
  if (!rows) return std::unexpected(rows.error());
  std::string insertion = "INSERT OR REPLACE INTO " + std::string(name) + " VALUES(?";
  for (std::size_t n = 1; n < table.columns.size(); ++n) insertion += ",?";
  auto insert = to.prepare(insertion + ")");
  if (!insert) return std::unexpected(insert.error());
  for (;;) {
    const auto row = rows->step();
    if (!row) return std::unexpected(row.error());
    if (!*row) return {};
    for (std::size_t n = 0; n < table.columns.size(); ++n) {
      const int column = static_cast<int>(n);
      if (table.columns[n] == 'i') insert->bind(column + 1, rows->integer(column));
      if (table.columns[n] == 't') insert->bind(column + 1, rows->text(column));
      if (table.columns[n] == 'b') insert->bind(column + 1, rows->blob(column));
    }
    if (auto stored = insert->step(); !stored) return std::unexpected(stored.error());
  }
}

}  // namespace kerf
