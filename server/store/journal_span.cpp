// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_span.h"

#include <string>

#include "server/store/journal_file.h"
#include "server/store/record_rows.h"
#include "server/store/record_span.h"

namespace kerf {

std::expected<std::vector<std::byte>, JournalError> journal_span(
    const std::filesystem::path& journal, std::uint64_t first, std::uint64_t last) {
  auto database = open_journal(journal, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  const auto failed = [&](const SqlError& error) {
    return std::unexpected(to_journal_error(journal, error));
  };
  // One transaction, so that the rows match the last record.
  if (auto begun = database->execute("BEGIN"); !begun) return failed(begun.error());
  const auto committed = last_record(*database);
  if (!committed) return failed(committed.error());
  if (first == 0 || first > last || last > *committed) return std::vector<std::byte>();
  const auto start = restart_before(*database, first);
  if (!start) return failed(start.error());
  auto rows = database->prepare(
      "SELECT first, count, wall_ms, span_ms, crc, bytes FROM batches WHERE first>=" +
      std::to_string(*start) + " AND first<=" + std::to_string(last) + " ORDER BY first");
  if (!rows) return failed(rows.error());
  std::vector<std::byte> span;
  for (;;) {
    const auto row = rows->step();
    if (!row) return failed(row.error());
    if (!*row) return span;
    const BatchHead head{static_cast<std::uint64_t>(rows->integer(0)),
                         static_cast<std::uint64_t>(rows->integer(1)), rows->integer(2),
                         rows->integer(3)};
    if (span.empty() && head.first > first) {
      return std::unexpected(JournalError{JournalErrorCode::kForeignVersion, journal.string(),
                                          first, "records of version 1 are in no span"});
    }
    append_span_row(span, {head, rows->integer(4), rows->blob(5)});
  }
}

}  // namespace kerf
