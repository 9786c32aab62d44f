// SPDX-License-Identifier: Apache-2.0
#include "server/history/journal_records.h"

#include <utility>

#include "server/store/journal_file.h"
#include "server/store/record_rows.h"

namespace kerf {
namespace {

using Done = std::expected<void, std::string>;

class JournalRecords final : public RecordSource {
 public:
  explicit JournalRecords(std::filesystem::path journal) : file_(std::move(journal)) {}

  // In one transaction, so that all ranges are of one state.
  Done read(std::span<const RecordRange> ranges,
            const std::function<void(JournalRecord& record)>& visit,
            const std::stop_token& stop) override {
    auto database = open_journal(file_, SqlMode::kRead);
    if (!database) return std::unexpected(describe(database.error()));
    if (stop.stop_possible()) database->end_on(stop);
    if (auto begun = database->execute("BEGIN"); !begun) {
      return std::unexpected(begun.error().reason);
    }
    for (const RecordRange& range : ranges) {
      if (auto done = read_range(*database, range, visit, stop); !done) return done;
    }
    return {};
  }

 private:
  Done read_range(SqlDatabase& database, const RecordRange& range,
                  const std::function<void(JournalRecord& record)>& visit,
                  const std::stop_token& stop) const {
    auto rows = RecordRows::open(file_, database, range.first);
    if (!rows) return std::unexpected(describe(rows.error()));
    for (;;) {
      if (stop.stop_requested()) return std::unexpected("stopped");
      auto record = rows->next();
      if (!record) return std::unexpected(describe(record.error()));
      if (!*record || (*record)->sequence > range.last) return {};
      visit(**record);
    }
  }

  std::filesystem::path file_;
};

}  // namespace

std::unique_ptr<RecordSource> journal_records(std::filesystem::path journal) {
  return std::make_unique<JournalRecords>(std::move(journal));
}

}  // namespace kerf
