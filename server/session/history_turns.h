// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <mutex>
#include <stop_token>

#include "server/threads/timed_mutex.h"

namespace kerf {

/// How long a request waits for other users of the history. File-making threads wait with it.
inline constexpr std::chrono::seconds kHistoryPatience{2};
inline constexpr const char* kOthersAskHistory =
    "other requests about the history of the session are running";

/// Grants the history of a session to one user at a time. A look back, which may take long, is
/// stopped when an urgent user such as undo asks. Thread-safe.
class HistoryTurns {
 public:
  /// The turn lasts as long as the lock. An unlocked lock means no turn.
  using Lock = std::unique_lock<TimedMutex>;

  /// Waits at most `patience` for a turn. Stops the current look back.
  Lock ask(std::chrono::milliseconds patience);
  /// Waits at most `patience` for a turn to look back, including while urgent users ask. `stop` is
  /// requested when one asks meanwhile: the turn should then end.
  Lock look_back(std::chrono::milliseconds patience, const std::stop_source& stop);
  /// Takes the turn if it is free.
  Lock try_now() { return Lock(turn_, std::try_to_lock); }

 private:
  TimedMutex turn_;
  std::mutex mutex_;                         ///< guards the next two
  int askers_ = 0;                           ///< threads waiting in ask()
  std::stop_source look_{std::nostopstate};  ///< stops the newest look back
};

}  // namespace kerf
