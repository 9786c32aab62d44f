// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <mutex>
#include <stop_token>

#include "server/threads/timed_mutex.h"

namespace kerf {

/// How long a request waits for others of the same session: threads that make files wait with it.
inline constexpr std::chrono::seconds kHistoryPatience{2};
inline constexpr const char* kOthersAskHistory =
    "other requests about the history of the session are running";

/// Who uses the history of a session: one at a time. Looks back, which may take long, stop for
/// those who ask for a turn, as undo does. Thread-safe.
class HistoryTurns {
 public:
  /// The turn lasts as long as the lock; one that is not locked is none.
  using Lock = std::unique_lock<TimedMutex>;

  /// Waits for a turn, at most so long. Stops the look back whose turn it is.
  Lock ask(std::chrono::milliseconds patience);
  /// Waits for a turn to look back, at most so long, also while others ask. `stop` is requested
  /// when somebody asks meanwhile: the turn should end then.
  Lock look_back(std::chrono::milliseconds patience, const std::stop_source& stop);
  /// Returns a turn if it is nobody else's.
  Lock try_now() { return Lock(turn_, std::try_to_lock); }

 private:
  TimedMutex turn_;
  std::mutex mutex_;                         ///< guards the next two
  int askers_ = 0;                           ///< who wait
  std::stop_source look_{std::nostopstate};  ///< of the last look back
};

}  // namespace kerf
