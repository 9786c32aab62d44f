// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/watchdog.h"

#include "haptic_agent/realtime/realtime_thread.h"

namespace kerf::agent {

bool Watchdog::check(std::uint64_t now_ns) {
  const std::uint64_t beat_ns = loop_.heartbeat_ns();
  if (beat_ns == 0 || now_ns < beat_ns || now_ns - beat_ns < ServoLoop::kStaleNs) {
    return false;
  }
  // At every check of a stall: a wrench may have been written after the first stop.
  stop_();
  if (beat_ns != stopped_at_) stops_.fetch_add(1);
  stopped_at_ = beat_ns;
  return true;
}

void Watchdog::start() {
  loop_.set_off_without_heartbeat(alarm_);
  thread_ = std::thread([this] {
    // If this is denied, the servo thread's warning explains it.
    request_fifo(kWatchdogPriority);
    MonotonicClock clock;
    while (!ending_.load()) {
      alarm_.wait();
      while (!ending_.load() && check(clock.now_ns())) {
        clock.sleep_until_ns(clock.now_ns() + kEveryNs);
      }
    }
  });
}

void Watchdog::end() {
  ending_.store(true);
  alarm_.end();
  if (thread_.joinable()) thread_.join();
}

std::uint64_t run_watched(ServoLoop& loop, ServoTask& task, const MotorSwitch& motors,
                          const std::function<void()>& prepare) {
  Watchdog watchdog(loop, motors.stop);
  watchdog.start();
  std::thread servo([&] {
    prepare();
    loop.run(task);
  });
  servo.join();
  watchdog.end();
  // The last tick may have output a force, and a device may ignore one of the two calls.
  motors.zero();
  motors.stop();
  return watchdog.stops();
}

}  // namespace kerf::agent
