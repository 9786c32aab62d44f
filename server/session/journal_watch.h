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

/// How much a JournalWatch does.
struct WatchOptions {
  std::size_t part_bytes = std::size_t{1} << 20;  ///< of records that are verified at a time
  /// After a part: at least this, and so many times as long as the part took.
  std::chrono::microseconds pause{50'000};
  int pause_factor = 19;
  std::chrono::microseconds idle{1'000'000};        ///< between two looks for sessions to verify
  Clock::duration again = std::chrono::hours(6);    ///< from pass to pass
  Clock::duration retry = std::chrono::minutes(1);  ///< after a failed read
  std::function<Clock::time_point()> now = Clock::now;
};

/// Reads the journals of the open sessions in the background and verifies their checksums, each
/// one soon after its session is opened, and then again and again: what a snapshot spares a restart
/// is read by nobody else until an undo needs it. Damage is noted in Session::health(). Takes a
/// twentieth of a core and 20 MB/s at most. Thread-safe.
class JournalWatch {
 public:
  /// `registry` and `executor`, a background thread, outlive it.
  JournalWatch(SessionRegistry& registry, Executor& executor, WatchOptions options = {});
  /// As stop().
  ~JournalWatch();
  JournalWatch(const JournalWatch&) = delete;
  JournalWatch& operator=(const JournalWatch&) = delete;

  void start();
  /// Ends the part that is being verified; afterwards no file is read.
  void stop();

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace kerf
