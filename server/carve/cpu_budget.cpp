// SPDX-License-Identifier: Apache-2.0
#include "server/carve/cpu_budget.h"

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "server/platform/clock.h"

namespace kerf {
namespace {

constexpr std::chrono::milliseconds kLook{5};

}  // namespace

CpuBudget::CpuBudget(double until_s, const std::stop_token& parent)
    : forward_(parent, [this] { source_.request_stop(); }),
      watcher_([this, until_s](const std::stop_token& end) {
        std::mutex mutex;
        std::condition_variable_any never;
        std::unique_lock lock(mutex);
        while (!end.stop_requested() && Clock::process_cpu_s() < until_s)
          never.wait_for(lock, end, kLook, [] { return false; });
        if (!end.stop_requested()) source_.request_stop();
      }) {}

}  // namespace kerf
