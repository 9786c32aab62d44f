// SPDX-License-Identifier: Apache-2.0
#include "server/store/page_check.h"

#include <string>

#include "server/store/journal_file.h"

namespace kerf {

std::expected<void, JournalError> check_pages(const std::filesystem::path& journal) {
  auto database = open_journal(journal, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  auto report = database->prepare("PRAGMA integrity_check(1)");
  if (!report) return std::unexpected(to_journal_error(journal, report.error()));
  const auto row = report->step();
  if (!row) return std::unexpected(to_journal_error(journal, row.error()));
  std::string found = *row ? report->text(0) : "the file cannot be verified";
  if (found == "ok") return {};
  // SQLite puts a title before the first damage that it reports.
  if (found.starts_with("***")) found.erase(0, found.find('\n') + 1);
  return std::unexpected(JournalError{JournalErrorCode::kCorrupt, journal.string(), 0, found});
}

}  // namespace kerf
