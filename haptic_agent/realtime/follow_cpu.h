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

/// Decides from the time that a thread works between its waits. A pure function of the times.
class PlaceChoice {
 public:
  /// Time over which the load is measured.
  static constexpr std::uint64_t kWindowNs = 50'000'000;
  /// Load up to which a thread may stay beside the loop, and down to which it must fall before it
  /// comes back. The threads of lower priority there get the rest.
  static constexpr double kHeavy = 0.5;
  static constexpr double kLight = 0.25;
  /// Work without a wait that counts as heavy at once.
  static constexpr std::uint64_t kLongNs = 5'000'000;

  /// The thread has been woken, and has done its work. Times must not decrease.
  void begin(std::uint64_t now_ns) noexcept;
  void end(std::uint64_t now_ns) noexcept;
  /// Work begins that may take long.
  void leave(std::uint64_t now_ns) noexcept;
  /// Nothing is known of the load any more.
  void reset() noexcept { *this = PlaceChoice(); }

  Place place() const noexcept { return place_; }

 private:
  void start_window(std::uint64_t now_ns) noexcept;

  Place place_ = Place::kAnywhere;
  std::optional<std::uint64_t> window_ns_;  ///< start of the window
  std::uint64_t woken_ns_ = 0, busy_ns_ = 0;
};

/// Keeps the calling thread on the processor of the real-time loop that wakes it, as long as its
/// work is light, and away from it otherwise. Waking a thread on another processor needs an
/// interrupt there, ends its sleep and finds cold caches; on the same one it is a switch of
/// threads, which a loop of higher priority never waits for. Where the loop is not real-time, or
/// its processor is not among those that the thread may use, nothing is changed.
class FollowCpu {
 public:
  /// Construct in the thread that is to be kept; `lead` may be null and must outlive the object.
  explicit FollowCpu(const LeadCpu* lead) noexcept;

  /// Call after each wait, and before the next one.
  void begin(std::uint64_t now_ns) noexcept { choice_.begin(now_ns); }
  void end(std::uint64_t now_ns) noexcept;
  /// Before work that may take long: threads of lower priority beside the loop must not wait.
  void leave(std::uint64_t now_ns) noexcept;
  /// Returns the thread to all its processors until the load is known again.
  void release() noexcept;

  Place place() const noexcept { return applied_; }

 private:
  void apply(Place place) noexcept;

  const LeadCpu* lead_;
  cpu_set_t allowed_{};
  PlaceChoice choice_;
  Place applied_ = Place::kAnywhere;
  int cpu_ = -1;  ///< the loop's processor when the place was applied
};

}  // namespace kerf::agent
