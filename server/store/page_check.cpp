// SPDX-License-Identifier: Apache-2.0
#include "server/store/page_check.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "server/store/journal_file.h"
#include "server/store/journal_tables.h"

namespace kerf {
namespace {

bool is_known(std::string_view table) {
  return std::ranges::find(kJournalTables, table, &JournalTable::name) != kJournalTables.end();
}

/// Returns the first table or index with a name that no journal has; empty if there is none. A
/// reader takes a table whose name is damaged for one that the journal does not have.
SqlResult<std::string> unknown_table(SqlDatabase& database) {
  for (const char* query : {"SELECT name, tbl_name, type FROM sqlite_schema",
                            "SELECT name, name, type FROM pragma_table_list WHERE schema='main'"}) {
    auto tables = database.prepare(query);
    if (!tables) return std::unexpected(tables.error());
    for (;;) {
      const auto row = tables->step();
      if (!row) return std::unexpected(row.error());
      if (!*row) break;
      const std::string name = tables->text(0), table = tables->text(1), type = tables->text(2);
      if (name == "sqlite_schema") continue;
      const bool is_table = type == "table" && is_known(name) && table == name;
      const bool is_index = type == "index" && is_known(table);
      if (!is_table && !is_index) return name;
    }
  }
  return std::string();
}

}  // namespace

std::expected<void, JournalError> check_pages(const std::filesystem::path& journal) {
  auto database = open_journal(journal, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  auto report = database->prepare("PRAGMA integrity_check(1)");
  if (!report) return std::unexpected(to_journal_error(journal, report.error()));
  const auto row = report->step();
  if (!row) return std::unexpected(to_journal_error(journal, row.error()));
  std::string found = *row ? report->text(0) : "the file cannot be verified";
  if (found == "ok") {
    const auto unknown = unknown_table(*database);
    if (!unknown) return std::unexpected(to_journal_error(journal, unknown.error()));
    if (unknown->empty()) return {};
    found = "it has a table " + *unknown + ", which no journal has";
  }
  // SQLite puts a title before the first damage that it reports.
  if (found.starts_with("***")) found.erase(0, found.find('\n') + 1);
  return std::unexpected(JournalError{JournalErrorCode::kCorrupt, journal.string(), 0, found});
}

}  // namespace kerf
