// SPDX-License-Identifier: Apache-2.0
#pragma once

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

  /// Servo thread. Returns false, and drops the sample, if the ring is full.
  bool push(const wire::MotionSample& sample) noexcept {
    const bool taken = samples_.push(sample);
    wake();
    return taken;
  }
  /// Servo thread. Fetches the newest answer; returns false if there is none since the last call.
  bool read(ServerWrench& answer) noexcept { return answers_.read(answer); }

  /// Replica thread. Fetches the next sample; returns false if there is none.
  bool pop(wire::MotionSample& sample) noexcept { return samples_.pop(sample); }
  void write(const ServerWrench& answer) noexcept { answers_.write(answer); }
  /// Replica thread. Sleeps until a sample is pushed or `wake` is called.
  void wait() noexcept {
    std::uint64_t times = 0;
    // An interrupting signal ends the wait too.
    [[maybe_unused]] const auto read_bytes = ::read(wake_, &times, sizeof times);
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
