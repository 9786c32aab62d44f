// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "server/platform/clock.h"
#include "server/threads/executor.h"

namespace kerf {

/// When a session writes its next snapshot.
struct SnapshotLimits {
  /// Replay time of a restart, beyond which a snapshot is due.
  std::chrono::microseconds replay_time{1'000'000};
  /// Age of a snapshot after which any further record makes it due.
  std::chrono::microseconds age{600'000'000};
  /// Minimum interval between two snapshots, unless a restart would take kUrgent times
  /// `replay_time`.
  std::chrono::microseconds pause{2'000'000};
};

/// SnapshotLimits::age where snapshots are copied to other servers: the server that continues a
/// session replays the records since.
inline constexpr std::chrono::seconds kCopiedSnapshotAge{10};

/// Decides when a session's snapshot is due. Times are of one steady clock.
class SnapshotSchedule {
 public:
  using Micros = std::chrono::microseconds;
  /// Writing takes at most one part in kShare of the time, unless it is urgent.
  static constexpr int kShare = 10;
  /// From kUrgent times the limit on, a snapshot is due at once. A restart then replays this much,
  /// and the work done while that snapshot was written.
  static constexpr int kUrgent = 2;
  /// Time to read one record from the journal, without applying it.
  static constexpr std::chrono::nanoseconds kRecordTime{1000};

  /// The snapshot holds the records up to `sequence`. A restart spent `replay_time` on the
  /// `records` after it.
  SnapshotSchedule(SnapshotLimits limits, std::uint64_t sequence, Micros replay_time,
                   Clock::time_point now)
      : limits_(limits), written_({sequence, -replay_time, now}), next_(now) {}

  void set(SnapshotLimits limits) { limits_ = limits; }
  /// Whether a snapshot is due after record `sequence`, if the session has spent `work` on motions
  /// since its start.
  bool is_due(std::uint64_t sequence, Micros work, Clock::time_point now) const {
    if (is_writing_ || sequence == written_.sequence) return false;
    const Micros replay = replay_time(sequence, work);
    if (now < next_) return !has_failed_ && replay >= kUrgent * limits_.replay_time;
    return replay >= limits_.replay_time || now - written_.at >= limits_.age;
  }
  /// Time that a restart would spend on the records after the snapshot.
  Micros replay_time(std::uint64_t sequence, Micros work) const {
    const auto reading = static_cast<std::int64_t>(sequence - written_.sequence) * kRecordTime;
    return work - written_.work + std::chrono::duration_cast<Micros>(reading);
  }
  void begin(std::uint64_t sequence, Micros work, Clock::time_point now) {
    is_writing_ = true;
    begun_ = {sequence, work, now};
  }
  void end(bool is_written, Clock::time_point now) {
    is_writing_ = false;
    has_failed_ = !is_written;
    next_ = now + std::max<Clock::duration>(limits_.pause, kShare * (now - begun_.at));
    if (is_written) written_ = begun_;
  }

 private:
  struct Snapshot {
    std::uint64_t sequence = 0;
    Micros work{0};
    Clock::time_point at;
  };
  SnapshotLimits limits_;
  Snapshot written_, begun_ = {};
  Clock::time_point next_;
  bool is_writing_ = false, has_failed_ = false;
};

/// How a session keeps snapshots next to its journal.
struct SnapshotOptions {
  /// Writes the snapshots and does other background work of the session. Must outlive the session.
  /// If null, no snapshots are written.
  Executor* writer = nullptr;
  SnapshotLimits limits;
  /// Called on any thread with the reason when a snapshot cannot be written, once per run of
  /// failures.
  std::function<void(const std::string& id, const std::string& reason)> on_failure = {};
};

}  // namespace kerf
