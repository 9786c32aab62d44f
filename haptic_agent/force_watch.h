// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "haptic_agent/force_reason.h"

namespace kerf::agent {

/// Decides when to tell the user why there is no force: once the reason has lasted for half a
/// second (a second if the force is only reduced), and the same reason again after 5 s (60 s) at
/// the earliest. Also reports that the force is on again. TripWriter reports trips, at once.
class ForceWatch {
 public:
  /// `reasons` must outlive the object.
  explicit ForceWatch(const ForceReasons& reasons) noexcept : reasons_(reasons) {}

  /// Returns the line to print now, without its full stop. May be empty. Call it ten times per
  /// second.
  std::string look(NoForce reason, std::uint64_t now_us);

 private:
  static constexpr std::uint64_t kBlockedUs = 500'000, kReducedUs = 1'000'000;
  static constexpr std::uint64_t kBlockedAgainUs = 5'000'000, kReducedAgainUs = 60'000'000;

  const ForceReasons& reasons_;
  NoForce reason_ = NoForce::kNone;
  std::uint64_t since_us_ = 0;
  /// The user was notified that there is no force.
  bool notified_ = false;
  bool said_ = false;  ///< the user was notified of reason_ since it began
  std::array<std::uint64_t, kNoForceNames.size()> said_us_{};
};

}  // namespace kerf::agent
