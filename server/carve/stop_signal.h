// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stop_token>
#include <thread>

namespace kerf {

/// Turns SIGINT and SIGTERM into a stop request for the work of this process. Work that does not
/// end within half a second of the signal (a long library call, one very long motion) is abandoned:
/// `abandon` is called on a thread of this object and the process exits at once with status(). Only
/// one object may exist at a time.
class StopSignal {
 public:
  /// `abandon` must be safe while the work still runs. It may, for example, remove unfinished
  /// files.
  explicit StopSignal(std::function<void()> abandon);
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;
  /// Restores the default actions of both signals.
  ~StopSignal();

  /// The token; a stop is requested at the signal.
  std::stop_token token() const { return source_.get_token(); }
  /// Returns the conventional exit status: 128 + the number of the signal (130 for SIGINT, 143 for
  /// SIGTERM), or 0 before a signal.
  static int status();

 private:
  void watch(const std::stop_token& end);

  std::function<void()> abandon_;
  std::stop_source source_;
  std::jthread watcher_;
};

}  // namespace kerf
