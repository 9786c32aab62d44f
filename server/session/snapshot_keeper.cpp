// SPDX-License-Identifier: Apache-2.0
#include "server/session/snapshot_keeper.h"

#include <utility>

#include "server/store/block_snapshot.h"
#include "server/store/journal_reader.h"

namespace kerf {
namespace {

/// A session that ends writes a snapshot if a restart would take this fraction of the limit.
constexpr int kLastSnapshotShare = 10;

}  // namespace

SnapshotKeeper::SnapshotKeeper(const Parts& parts, const SnapshotSchedule& schedule,
                               UsedSnapshot newest, SessionOwner owner,
                               std::function<bool()> is_between_records)
    : id_(parts.id),
      executor_(parts.executor),
      sculpture_(parts.sculpture),
      journal_(parts.journal),
      carving_(parts.carving),
      owner_(std::move(owner)),
      is_between_records_(std::move(is_between_records)),
      schedule_(schedule),
      good_(newest) {}

void SnapshotKeeper::keep(SnapshotOptions options) {
  options_ = std::move(options);
  schedule_.set(options_.limits);
  executor_.post([this, watched = owner_.watch()] {
    if (const auto session = watched.lock()) write_if_due();
  });
}

void SnapshotKeeper::write_if_due() {
  const auto now = Clock::now();
  if (options_.writer == nullptr || closed_ || is_between_records_()) return;
  if (!schedule_.is_due(journal_.sequence(), carving_.work_time(), now) || disk_is_low_) return;
  schedule_.begin(journal_.sequence(), carving_.work_time(), now);
  // The tiles are shared, and copied one by one when they are cut next, some microseconds each.
  options_.writer->post(
      [this, session = owner_.hold(), at = journal_.sequence(), state = sculpture_.state()] {
        const auto end = [&](bool is_written) {
          executor_.post([this, session, is_written] { schedule_.end(is_written, Clock::now()); });
        };
        try {
          end(write(at, state).has_value());
        } catch (...) {  // the next snapshot becomes due as usual
          end(false);
          throw;
        }
      });
}

/// Writes the state after record `at` once that record is committed. Reports the first failure
/// after a success.
std::expected<void, std::string> SnapshotKeeper::write(std::uint64_t at,
                                                       const SculptureState& state) {
  const std::lock_guard lock(mutex_);
  if (has_ended_) return {};
  auto written = write_locked(at, state);
  const bool failed_before = std::exchange(has_failed_, !written);
  if (!written && !failed_before && options_.on_failure) {
    options_.on_failure(id_, written.error());
  }
  return written;
}

std::expected<void, std::string> SnapshotKeeper::write_locked(std::uint64_t at,
                                                              const SculptureState& state) {
  if (const auto flushed = journal_.flush(); !flushed) {
    return std::unexpected(describe(flushed.error()));
  }
  auto reader = JournalReader::open(journal_.file());
  if (!reader) return std::unexpected(describe(reader.error()));
  const auto mark = reader->mark(at);
  if (!mark) return std::unexpected(describe(mark.error()));
  if (!*mark) return std::unexpected("record " + std::to_string(at) + " is not in the journal");
  const SnapshotHead head{.kernel_version = kKernelVersion,
                          .session = reader->header().session,
                          .sequence = at,
                          .hash = state.solid.hash(),
                          .mark = **mark};
  const auto previous = previous_snapshot_file(journal_.file());
  const bool keeps_newest = good_ == UsedSnapshot::kNewest;
  const auto written = write_snapshot(snapshot_file(journal_.file()), head, state,
                                      keeps_newest ? previous : std::filesystem::path());
  if (!written) return std::unexpected(written.error().reason);
  std::error_code often_absent;
  if (good_ == UsedSnapshot::kNone) std::filesystem::remove(previous, often_absent);
  good_ = UsedSnapshot::kNewest;
  return {};
}

void SnapshotKeeper::close() {
  closed_ = true;
  if (options_.writer == nullptr || is_between_records_() || disk_is_low_) return;
  const auto replay_time = schedule_.replay_time(journal_.sequence(), carving_.work_time());
  if (replay_time * kLastSnapshotShare < options_.limits.replay_time) return;
  last_state_ = std::make_unique<SculptureState>(sculpture_.state());
}

std::expected<void, JournalError> SnapshotKeeper::finish_journal(bool with_snapshot) {
  // A failure has been reported and only costs time at the next start.
  if (with_snapshot && last_state_) (void)write(journal_.sequence(), *last_state_);
  const std::lock_guard lock(mutex_);
  has_ended_ = true;
  return journal_.finish();
}

}  // namespace kerf
