// SPDX-License-Identifier: Apache-2.0
#include "server/session/history_turns.h"

#include <thread>

#include "server/platform/clock.h"

namespace kerf {
namespace {

/// Polling interval while urgent users wait.
constexpr std::chrono::milliseconds kBetweenLooks{1};

}  // namespace

HistoryTurns::Lock HistoryTurns::ask(std::chrono::milliseconds patience) {
  {
    const std::lock_guard guard(mutex_);
    ++askers_;
    look_.request_stop();
  }
  Lock lock(turn_, patience);
  const std::lock_guard guard(mutex_);
  --askers_;
  return lock;
}

HistoryTurns::Lock HistoryTurns::look_back(std::chrono::milliseconds patience,
                                           const std::stop_source& stop) {
  const auto end = Clock::now() + patience;
  for (;;) {
    Lock lock(turn_, end);
    if (!lock) return lock;
    {
      const std::lock_guard guard(mutex_);
      if (askers_ == 0) {
        look_ = stop;
        return lock;
      }
    }
    lock.unlock();
    std::this_thread::sleep_for(kBetweenLooks);
    if (Clock::now() >= end) return lock;
  }
}

}  // namespace kerf
