// SPDX-License-Identifier: Apache-2.0
#include "server/session/session_past_source.h"

#include <utility>

#include "kernel/cut/workers.h"
#include "server/history/journal_records.h"
#include "server/session/session.h"
#include "server/store/journal_times.h"

namespace kerf {
namespace {

class SessionPastSource final : public PastSource {
 public:
  explicit SessionPastSource(std::shared_ptr<Session> session)
      : session_(std::move(session)), records_(journal_records(session_->journal_file())) {}

  std::shared_ptr<const Scene> scene() const override { return session_->scene(); }

  std::expected<std::optional<std::vector<TileReplacement>>, std::string> tiles_at(
      std::uint64_t record, const std::stop_token& stop) override {
    SerialWorkers alone;
    return session_->past().tiles_at(record, alone, stop);
  }

  std::expected<std::int64_t, std::string> time_of(std::uint64_t record) override {
    const auto time = kerf::time_of(session_->journal_file(), record);
    if (!time) return std::unexpected(describe(time.error()));
    return *time;
  }

  std::expected<std::vector<JournalRecord>, std::string> records_after(
      std::uint64_t record, std::size_t count, const std::stop_token& stop) override {
    std::vector<JournalRecord> records;
    if (session_->committed() <= record) return records;
    const RecordRange next{record + 1, record + count};
    const auto add = [&](JournalRecord& each) { records.push_back(std::move(each)); };
    if (auto read = records_->read({&next, 1}, add, stop); !read) {
      return std::unexpected(read.error());
    }
    return records;
  }

 private:
  std::shared_ptr<Session> session_;
  std::unique_ptr<RecordSource> records_;
};

}  // namespace

std::unique_ptr<PastSource> past_of(std::shared_ptr<Session> session) {
  return std::make_unique<SessionPastSource>(std::move(session));
}

}  // namespace kerf
