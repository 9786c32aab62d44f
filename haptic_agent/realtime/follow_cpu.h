// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sched.h>

#include <cstdint>
#include <optional>

#include "haptic_agent/realtime/lead_cpu.h"

namespace kerf::agent {

/// Where a thread runs relative to the loop that wakes it.
enum class Place : std::uint8_t {
  kAnywhere,
  kBeside,  ///< on the loop's processor
  kApart,   ///< on the other processors
};

/// Chooses the place of a thread from the time that it works between its waits. Depends on the
/// given times only.
class PlaceChoice {
 public:
  /// Time over which the load is measured.
  static constexpr std::uint64_t kWindowNs = 50'000'000;
  /// A thread moves away from the loop above this load, and returns below half of it. Threads of
  /// lower priority on the same processor get the rest.
  static constexpr double kHeavy = 0.5;
  static constexpr double kLight = 0.25;
  /// Work without a wait that counts as heavy at once.
  static constexpr std::uint64_t kLongNs = 5'000'000;

  /// `begin`: the thread was woken; `end`: its work is done. Times must not decrease.
  void begin(std::uint64_t now_ns) noexcept;
  void end(std::uint64_t now_ns) noexcept;
  /// Announces work that may take long.
  void leave(std::uint64_t now_ns) noexcept;
  /// Forgets the measured load.
  void reset() noexcept { *this = PlaceChoice(); }

  Place place() const noexcept { return place_; }

 private:
  void start_window(std::uint64_t now_ns) noexcept;

  Place place_ = Place::kAnywhere;
  std::optional<std::uint64_t> window_ns_;  ///< start of the window
  std::uint64_t woken_ns_ = 0, busy_ns_ = 0;
};

/// Keeps the calling thread on the processor of the real-time loop that wakes it while its work is
/// light, and off that processor otherwise. Waking a thread on another processor needs an interrupt
/// there, ends its idle state and finds cold caches. On the same processor it is a context switch,
/// for which a loop of higher priority never waits. Nothing changes if the loop is not real-time or
/// the thread may not use its processor.
class FollowCpu {
 public:
  /// Construct in the thread to be placed; `lead` may be null and must outlive the object.
  explicit FollowCpu(const LeadCpu* lead) noexcept;

  /// Call after each wait, and before the next one.
  void begin(std::uint64_t now_ns) noexcept { choice_.begin(now_ns); }
  void end(std::uint64_t now_ns) noexcept;
  /// Call before work that may take long, so that threads of lower priority on the loop's processor
  /// need not wait.
  void leave(std::uint64_t now_ns) noexcept;
  /// Allows the thread all its processors until the load is known again.
  void release() noexcept;

  Place place() const noexcept { return applied_; }

 private:
  void apply(Place place) noexcept;

  const LeadCpu* lead_;
  cpu_set_t allowed_{};
  PlaceChoice choice_;
  Place applied_ = Place::kAnywhere;
  int cpu_ = -1;  ///< the loop's processor when the thread was placed
};

}  // namespace kerf::agent
