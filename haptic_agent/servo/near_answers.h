// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>

#include "haptic_agent/servo/latest_value.h"
#include "haptic_agent/servo/sample_ring.h"
#include "haptic_agent/servo/server_wrench.h"

namespace kerf::agent {

/// Between the servo and whoever answers its samples from near by, from a copy of the block.
class NearAnswers {
 public:
  NearAnswers() noexcept : wake_(::eventfd(0, EFD_CLOEXEC)) {}
  ~NearAnswers() { ::close(wake_); }
  NearAnswers(const NearAnswers&) = delete;
  NearAnswers& operator=(const NearAnswers&) = delete;

  /// Servo thread. False if the other side is a whole ring behind.
  bool push(const wire::MotionSample& sample) noexcept {
    const bool taken = samples_.push(sample);
    wake();
    return taken;
  }
  /// Servo thread: the newest answer, if there is a newer one than at the last call.
  bool read(ServerWrench& answer) noexcept { return answers_.read(answer); }

  /// The other side: the next sample; false if there is none.
  bool pop(wire::MotionSample& sample) noexcept { return samples_.pop(sample); }
  void write(const ServerWrench& answer) noexcept { answers_.write(answer); }
  /// The other side: sleeps until there is a sample, or until somebody calls wake.
  void wait() noexcept {
    std::uint64_t times = 0;
    // A wait that a signal ends is a wait that has ended.
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
