// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "server/platform/clock.h"

namespace kerf {

/// How far the copy of a session's journal on other machines has come.
struct CopyState {
  std::uint64_t record = 0;  ///< last record whose copy was acknowledged
  std::string fault;         ///< why nothing is copied, as one sentence; else empty
  /// Commits since the journal was opened (JournalFigures) that are copied entirely, with all
  /// earlier ones; nullopt while the copy is behind the journal as it was opened.
  std::optional<std::uint64_t> commits = {};
  friend bool operator==(const CopyState&, const CopyState&) = default;
};

/// The newest CopyState of a session; nullopt if no copy is made. Thread-safe.
class CopyNote {
 public:
  void set(CopyState state) {
    {
      const std::lock_guard lock(mutex_);
      record_ = state.record;
      state_ = std::move(state);
    }
    changed_.notify_all();
  }
  std::optional<CopyState> get() const {
    const std::lock_guard lock(mutex_);
    return state_;
  }
  /// CopyState::record; 0 if no copy is made. Does not block.
  std::uint64_t record() const { return record_; }
  /// Blocks until this many commits are copied, or until `end`. Returns whether they are.
  bool wait_for(std::uint64_t commits, Clock::time_point end) const {
    std::unique_lock lock(mutex_);
    return changed_.wait_until(
        lock, end, [&] { return state_ && state_->commits && *state_->commits >= commits; });
  }
  /// Last record of the newest snapshot that was copied; 0 if none was.
  void set_snapshot(std::uint64_t record) { snapshot_ = record; }
  std::uint64_t snapshot() const { return snapshot_; }

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::optional<CopyState> state_;
  std::atomic<std::uint64_t> record_ = 0, snapshot_ = 0;
};

}  // namespace kerf
