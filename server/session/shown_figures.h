// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "server/platform/clock.h"
#include "server/session/session_info.h"

namespace kerf {

/// The figures of a session for other threads, which do not wait for its executor.
class ShownFigures {
 public:
  /// Any thread.
  SessionFigures get() const {
    return {motions_, removed_mm3_, participants_, created_ms_, active_ms_};
  }
  /// Sets the times, as read from the journal. Call once, before the session is used.
  void set_times(std::int64_t created_ms, std::int64_t active_ms) {
    created_ms_ = created_ms;
    active_ms_ = active_ms;
  }
  /// Shows these figures. The session is active now if they differ from those shown; the volume
  /// alone differs after an undo. Executor only.
  void show(std::uint64_t motions, double removed_mm3, std::size_t participants) {
    const auto relaxed = std::memory_order_relaxed;
    if (motions_.load(relaxed) != motions || removed_mm3_.load(relaxed) != removed_mm3 ||
        participants_.load(relaxed) != participants) {
      active_ms_.store(Clock::wall_ms(), relaxed);
    }
    motions_.store(motions, relaxed);
    removed_mm3_.store(removed_mm3, relaxed);
    participants_.store(participants, relaxed);
  }

 private:
  std::atomic<std::uint64_t> motions_ = 0;
  std::atomic<double> removed_mm3_ = 0;
  std::atomic<std::size_t> participants_ = 0;
  std::atomic<std::int64_t> created_ms_ = 0, active_ms_ = 0;
};

}  // namespace kerf
