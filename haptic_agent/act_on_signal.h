// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <functional>
#include <mutex>
#include <thread>

namespace kerf::agent {

/// Handles the signals of the process on its own thread: SIGINT and SIGTERM end the program,
/// SIGUSR1 re-arms. Construct it before any other thread starts, so that all threads inherit the
/// blocked signals and only this one receives them. The destructor unblocks them again.
class ActOnSignal {
 public:
  ActOnSignal();
  ~ActOnSignal();
  ActOnSignal(const ActOnSignal&) = delete;
  ActOnSignal& operator=(const ActOnSignal&) = delete;

  // Each of these functions replaces an action, which may be null. Once it has returned, the old
  // action neither runs nor will run, so its captures may be destroyed. An action must not call
  // them.

  /// If a signal to end arrived while there was no action, this one runs at once.
  void on_leave(std::function<void()> action);
  void on_rearm(std::function<void()> action);

 private:
  void wait(const std::stop_token& stop);

  sigset_t signals_{}, before_{};
  std::mutex mutex_;  ///< guards the members below, and the actions while they run
  std::function<void()> leave_, rearm_;
  bool leaves_ = false;  ///< a signal to end has arrived
  std::jthread thread_;
};

}  // namespace kerf::agent
