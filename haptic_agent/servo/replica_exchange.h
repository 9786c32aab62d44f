// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>

#include "haptic_agent/realtime/latest_value.h"
#include "haptic_agent/servo/sample_ring.h"
#include "haptic_agent/servo/server_wrench.h"

namespace kerf::agent {

/// Lock-free exchange between the servo thread and the local replica thread: samples in one
/// direction, answers in the other. Only the replica thread waits.
class ReplicaExchange {
 public:
  ReplicaExchange() noexcept : wake_(::eventfd(0, EFD_CLOEXEC)) {}
  ~ReplicaExchange() { ::close(wake_); }
  ReplicaExchange(const ReplicaExchange&) = delete;
  ReplicaExchange& operator=(const ReplicaExchange&) = delete;

  /// Servo thread. Returns false and drops the sample if the ring is full. Does not wake the
  /// replica.
  bool push(const wire::MotionSample& sample) noexcept { return samples_.push(sample); }
  /// Servo thread. Fetches the newest answer. Returns false if there is none since the last call.
  bool read(ServerWrench& answer) noexcept { return answers_.read(answer); }

  /// Replica thread. Fetches the next sample. Returns false if there is none.
  bool pop(wire::MotionSample& sample) noexcept { return samples_.pop(sample); }
  void write(const ServerWrench& answer) noexcept { answers_.write(answer); }
  /// Replica thread. Sleeps until `wake` is called. Returns at once if it was called since the last
  /// `wait`.
  void wait() noexcept {
    std::uint64_t times = 0;
    // An interrupting signal ends the wait too.
    [[maybe_unused]] const auto read_bytes = ::read(wake_, &times, sizeof times);
  }
  /// Returns whether `wait` would return at once.
  bool is_woken() const noexcept {
    pollfd event{.fd = wake_, .events = POLLIN, .revents = 0};
    return ::poll(&event, 1, 0) == 1;
  }
  void wake() noexcept {
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = ::write(wake_, &one, sizeof one);
  }

 private:
  SampleRing samples_;
  LatestValue<ServerWrench> answers_;
  int wake_;
};

}  // namespace kerf::agent
