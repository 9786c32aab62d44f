// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf::agent {

/// A timer of the kernel that one thread keeps putting off and another one waits for. Putting it
/// off wakes nobody, and costs a tenth of waking a thread that looks at a clock.
class Alarm {
 public:
  /// If the process may open no more files, `wait` returns every 5 ms instead.
  Alarm() noexcept;
  ~Alarm();
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;

  /// Lets it go off at `time_ns` of CLOCK_MONOTONIC, instead of when it was to before. Does not
  /// wait or allocate.
  void set(std::uint64_t time_ns) noexcept;
  /// Waits until it has gone off since it was set, or `end` was called. From one thread.
  void wait() noexcept;
  /// Ends `wait`, now and later. From any thread.
  void end() noexcept;

 private:
  int timer_, ended_;
};

}  // namespace kerf::agent
