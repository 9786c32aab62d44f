// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>

#include "haptic_agent/servo/servo_loop.h"

namespace kerf::agent {

/// Looks at a loop's heartbeat from a thread of its own, above the loop's priority, and stops the
/// device when the loop has done nothing for too long. The loop itself trips when it comes back.
class Watchdog {
 public:
  static constexpr std::uint64_t kEveryNs = 5'000'000;
  static constexpr std::uint64_t kStaleNs = 10'000'000;

  /// `loop` and what `stop` refers to must outlive it. `stop` must not wait.
  Watchdog(const ServoLoop& loop, std::function<void()> stop)
      : loop_(loop), stop_(std::move(stop)) {}
  ~Watchdog() { end(); }
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  void start();
  void end();
  /// One look at this time, ns on the loop's clock: true if it stopped the device.
  bool look(std::uint64_t now_ns);
  /// How often the loop was found standing still.
  std::uint64_t stops() const noexcept { return stops_.load(); }

 private:
  const ServoLoop& loop_;
  std::function<void()> stop_;
  std::atomic<std::uint64_t> stops_{0};
  std::uint64_t stopped_at_ = 0;  ///< the heartbeat for which the device was stopped last
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace kerf::agent
