// SPDX-License-Identifier: Apache-2.0
#include "server/carve/stop_signal.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <utility>

namespace kerf {
namespace {

// A signal handler cannot wake a thread in standard C++, so the watcher polls the flag.
constexpr std::chrono::milliseconds kSignalLook{20};
constexpr std::chrono::milliseconds kGrace{500};
constexpr int kStatusOfSignals = 128;

std::atomic<int> signal_seen = 0;
static_assert(std::atomic<int>::is_always_lock_free);

void on_signal(int signal) { signal_seen = signal; }

// Sleeps. Returns early if `end` is requested.
void wait_for(std::chrono::milliseconds time, const std::stop_token& end) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, end, time, [] { return false; });
}

}  // namespace

StopSignal::StopSignal(std::function<void()> abandon) : abandon_(std::move(abandon)) {
  signal_seen = 0;
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  watcher_ = std::jthread([this](const std::stop_token& end) { watch(end); });
}

StopSignal::~StopSignal() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

int StopSignal::status() {
  const int signal = signal_seen;
  return signal == 0 ? 0 : kStatusOfSignals + signal;
}

void StopSignal::watch(const std::stop_token& end) {
  while (!end.stop_requested() && signal_seen == 0) wait_for(kSignalLook, end);
  if (end.stop_requested()) return;
  source_.request_stop();
  wait_for(kGrace, end);
  if (end.stop_requested()) return;
  abandon_();
  ::_exit(status());
}

}  // namespace kerf
