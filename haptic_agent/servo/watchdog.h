// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>

#include "haptic_agent/servo/servo_loop.h"

namespace kerf::agent {

/// Stops the device, from a thread of higher priority, when a loop's heartbeat is missing. The
/// thread sleeps until an alarm goes off, which the running loop postpones. The loop itself trips
/// when it resumes.
class Watchdog {
 public:
  /// Period at which the device is stopped during a stall.
  static constexpr std::uint64_t kEveryNs = 5'000'000;

  /// `loop` and everything that `stop` refers to must outlive the watchdog. `stop` must not wait.
  Watchdog(ServoLoop& loop, std::function<void()> stop) : loop_(loop), stop_(std::move(stop)) {}
  ~Watchdog() { end(); }
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  /// Call before the loop runs.
  void start();
  /// Call after the loop has ended.
  void end();
  /// Checks the heartbeat at `now_ns` on the loop's clock. Returns true if it stopped the device.
  bool check(std::uint64_t now_ns);
  /// Number of stalls detected.
  std::uint64_t stops() const noexcept { return stops_.load(); }

 private:
  ServoLoop& loop_;
  Alarm alarm_;
  std::function<void()> stop_;
  std::atomic<std::uint64_t> stops_{0};
  std::uint64_t stopped_at_ = 0;  ///< heartbeat of the latest stall
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

/// The motors of a loop's device.
struct MotorSwitch {
  /// Outputs a wrench of zero. Called when the servo thread has ended.
  std::function<void()> zero;
  /// Callable from any thread. Must not wait.
  std::function<void()> stop;
};

/// Runs the loop on a new thread, which calls `prepare` first, with a watchdog. When the loop has
/// ended, for any reason, the motors are set to zero and stopped. Returns the number of stalls.
std::uint64_t run_watched(ServoLoop& loop, ServoTask& task, const MotorSwitch& motors,
                          const std::function<void()>& prepare);

}  // namespace kerf::agent
