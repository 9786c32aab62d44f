// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_times.h"

#include <algorithm>
#include <optional>
#include <string>

#include "server/store/journal_file.h"
#include "server/store/record_batch.h"
#include "server/store/record_rows.h"

namespace kerf {
namespace {

/// Returns the last batch that meets a condition; nullopt if none does.
SqlResult<std::optional<BatchHead>> last_batch(SqlDatabase& database,
                                               const std::string& condition) {
  const auto exists = database.has_table("batches");
  if (!exists) return std::unexpected(exists.error());
  if (!*exists) return std::nullopt;
  auto rows = database.prepare("SELECT first, count, wall_ms, span_ms FROM batches WHERE " +
                               condition + " ORDER BY first DESC LIMIT 1");
  if (!rows) return std::unexpected(rows.error());
  const auto row = rows->step();
  if (!row) return std::unexpected(row.error());
  if (!*row) return std::nullopt;
  return BatchHead{static_cast<std::uint64_t>(rows->integer(0)),
                   static_cast<std::uint64_t>(rows->integer(1)), rows->integer(2),
                   rows->integer(3)};
}

/// Returns the last record before all batches.
SqlResult<std::uint64_t> last_without_time(SqlDatabase& database) {
  const auto exists = database.has_table("commands");
  if (!exists) return std::unexpected(exists.error());
  if (!*exists) return 0;
  const auto last = database.integer("SELECT coalesce(max(sequence),0) FROM commands");
  if (!last) return std::unexpected(last.error());
  return static_cast<std::uint64_t>(*last);
}

}  // namespace

std::expected<std::uint64_t, JournalError> record_at(const std::filesystem::path& journal,
                                                     std::int64_t wall_ms) {
  auto database = open_journal(journal, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  const auto failed = [&](const SqlError& error) {
    return std::unexpected(to_journal_error(journal, error));
  };
  const auto batch = last_batch(*database, "wall_ms<=" + std::to_string(wall_ms));
  if (!batch) return failed(batch.error());
  if (!*batch) {
    const auto last = last_without_time(*database);
    return last ? std::expected<std::uint64_t, JournalError>(*last) : failed(last.error());
  }
  const BatchHead& head = **batch;
  std::uint64_t begun = 1, end = head.count;  // records before `begun` are in time
  while (begun < end) {
    const std::uint64_t middle = begun + (end - begun) / 2;
    if (head.wall_ms_of(middle) <= wall_ms) {
      begun = middle + 1;
    } else {
      end = middle;
    }
  }
  return head.first + begun - 1;
}

std::expected<std::int64_t, JournalError> time_of(const std::filesystem::path& journal,
                                                  std::uint64_t record) {
  auto database = open_journal(journal, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  const auto batch = last_batch(*database, "first<=" + std::to_string(record));
  if (!batch) return std::unexpected(to_journal_error(journal, batch.error()));
  if (!*batch || record - (*batch)->first >= (*batch)->count) return 0;
  return (*batch)->wall_ms_of(record - (*batch)->first);
}

}  // namespace kerf
