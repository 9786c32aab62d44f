// SPDX-License-Identifier: Apache-2.0
// The part of Session that writes snapshots of its block next to its journal.
#include <utility>

#include "server/session/session.h"
#include "server/store/block_snapshot.h"

namespace kerf {
namespace {

/// A session that ends writes a snapshot if a restart would take this fraction of the limit.
constexpr int kLastSnapshotShare = 10;

}  // namespace

void Session::keep_snapshots(SnapshotOptions options) {
  snapshots_ = std::move(options);
  schedule_.set(snapshots_.limits);
  if (snapshots_.writer != nullptr) {
    past_.read_ahead_on(*snapshots_.writer);
    stroke_changes_.work_on(*snapshots_.writer);
  }
  executor_->post([weak = weak_from_this()] {
    if (const auto self = weak.lock()) self->write_snapshot_if_due();
  });
}

void Session::write_snapshot_if_due() {
  const auto now = Clock::now();
  if (snapshots_.writer == nullptr || closed_ || is_between_records()) return;
  if (!schedule_.is_due(sequence(), carving_.work_time(), now) || disk_is_low_) return;
  schedule_.begin(sequence(), carving_.work_time(), now);
  // The tiles are shared, and copied one by one when they are cut next, some microseconds each.
  snapshots_.writer->post([self = shared_from_this(), at = sequence(), state = sculpture_.state()] {
    const auto end = [&](bool is_written) {
      self->executor_->post([self, is_written] { self->schedule_.end(is_written, Clock::now()); });
    };
    try {
      end(self->write_snapshot(at, state).has_value());
    } catch (...) {  // the next snapshot becomes due as usual
      end(false);
      throw;
    }
  });
}

/// Writes the state after record `at` once that record is committed. Reports the first failure
/// after a success.
std::expected<void, std::string> Session::write_snapshot(std::uint64_t at,
                                                         const SculptureState& state) {
  const std::lock_guard lock(snapshot_mutex_);
  if (snapshots_ended_) return {};
  auto written = write_snapshot_locked(at, state);
  const bool failed_before = std::exchange(snapshots_fail_, !written);
  if (!written && !failed_before && snapshots_.on_failure) {
    snapshots_.on_failure(id_, written.error());
  }
  return written;
}

std::expected<void, std::string> Session::write_snapshot_locked(std::uint64_t at,
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
  const bool keeps_newest = good_snapshot_ == UsedSnapshot::kNewest;
  const auto written = kerf::write_snapshot(snapshot_file(journal_.file()), head, state,
                                            keeps_newest ? previous : std::filesystem::path());
  if (!written) return std::unexpected(written.error().reason);
  std::error_code often_absent;
  if (good_snapshot_ == UsedSnapshot::kNone) std::filesystem::remove(previous, often_absent);
  good_snapshot_ = UsedSnapshot::kNewest;
  return {};
}

/// Called by close(), after which nothing is applied.
void Session::keep_last_state() {
  if (snapshots_.writer == nullptr || is_between_records() || disk_is_low_) return;
  const auto replay_time = schedule_.replay_time(sequence(), carving_.work_time());
  if (replay_time * kLastSnapshotShare < snapshots_.limits.replay_time) return;
  last_state_ = std::make_unique<SculptureState>(sculpture_.state());
}

std::expected<void, JournalError> Session::finish_journal(bool with_snapshot) {
  // A failure has been reported and only costs time at the next start.
  if (with_snapshot && last_state_) (void)write_snapshot(sequence(), *last_state_);
  const std::lock_guard lock(snapshot_mutex_);
  snapshots_ended_ = true;
  return journal_.finish();
}

}  // namespace kerf
