// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/act_on_signal.h"

#include <ctime>
#include <utility>

namespace kerf::agent {

ActOnSignal::ActOnSignal() {
  sigemptyset(&signals_);
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) sigaddset(&signals_, signal);
  pthread_sigmask(SIG_BLOCK, &signals_, &before_);
  thread_ = std::jthread([this](const std::stop_token& stop) { wait(stop); });
}

ActOnSignal::~ActOnSignal() {
  thread_.request_stop();
  thread_.join();
  // A signal that is still pending would end the process as soon as it is unblocked.
  constexpr timespec kAtOnce{};
  while (sigtimedwait(&signals_, nullptr, &kAtOnce) > 0) {
  }
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

void ActOnSignal::on_leave(std::function<void()> action) {
  const std::scoped_lock lock(mutex_);
  leave_ = std::move(action);
  if (leaves_ && leave_) leave_();
}

void ActOnSignal::on_rearm(std::function<void()> action) {
  const std::scoped_lock lock(mutex_);
  rearm_ = std::move(action);
}

void ActOnSignal::wait(const std::stop_token& stop) {
  constexpr timespec kLookUp{.tv_sec = 0, .tv_nsec = 100'000'000};
  while (!stop.stop_requested()) {
    const int signal = sigtimedwait(&signals_, nullptr, &kLookUp);
    const std::scoped_lock lock(mutex_);
    if (signal == SIGUSR1 && rearm_) rearm_();
    if (signal != SIGINT && signal != SIGTERM) continue;
    leaves_ = true;
    if (leave_) leave_();
  }
}

}  // namespace kerf::agent
