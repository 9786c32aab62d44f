// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>

#include "server/platform/clock.h"
#include "server/session/session_registry.h"
#include "server/threads/executor.h"

namespace kerf {

/// The pace of a JournalWatch.
struct WatchOptions {
  std::size_t part_bytes = std::size_t{1} << 20;  ///< bytes of records verified at a time
  /// Pause after each part: `pause` or `pause_factor` times the duration of the part, the longer
  /// one.
  std::chrono::microseconds pause{50'000};
  int pause_factor = 19;
  std::chrono::microseconds idle{1'000'000};        ///< between two searches for sessions to verify
  Clock::duration again = std::chrono::hours(6);    ///< interval between passes
  Clock::duration retry = std::chrono::minutes(1);  ///< after a failed read
  std::function<Clock::time_point()> now = Clock::now;
};

/// Verifies the checksums of the journals of open sessions in the background: each one soon after
/// its session is opened, and periodically afterwards. Nobody else reads the records before a
/// snapshot until an undo needs them. Reports damage to Session::health(). Uses at most a twentieth
/// of a core and 20 MB/s. Thread-safe.
class JournalWatch {
 public:
  /// `registry` and `executor` (a background thread) must outlive it.
  JournalWatch(SessionRegistry& registry, Executor& executor, WatchOptions options = {});
  /// Calls stop().
  ~JournalWatch();
  JournalWatch(const JournalWatch&) = delete;
  JournalWatch& operator=(const JournalWatch&) = delete;

  void start();
  /// Ends the verification in progress. No file is read afterwards.
  void stop();

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace kerf
