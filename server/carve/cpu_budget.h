// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stop_token>
#include <thread>

namespace kerf {

/// Requests a stop when this process has used a given CPU time, or when another stop is requested.
/// Polls every 5 ms.
class CpuBudget {
 public:
  /// Stops at Clock::process_cpu_s() >= `until_s`, or with `parent`.
  CpuBudget(double until_s, const std::stop_token& parent);
  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  std::stop_callback<std::function<void()>> forward_;
  std::jthread watcher_;
};

}  // namespace kerf
