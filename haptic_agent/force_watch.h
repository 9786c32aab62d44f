// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "haptic_agent/force_reason.h"

namespace kerf::agent {

/// Decides when the user is notified why there is no force: of a reason that lasts for half a
/// second, or, if the force is only reduced, for a second; of the same one again after 5 and 60 s
/// at the earliest; and that the force is on again. Trips are not among them: TripWriter tells of
/// each at once.
class ForceWatch {
 public:
  /// `reasons` must outlive the object.
  explicit ForceWatch(const ForceReasons& reasons) noexcept : reasons_(reasons) {}

  /// Returns the line to print now, without its full stop; empty if there is none. Call it ten
  /// times per second.
  std::string look(NoForce reason, std::uint64_t now_us);

 private:
  static constexpr std::uint64_t kBlockedUs = 500'000, kReducedUs = 1'000'000;
  static constexpr std::uint64_t kBlockedAgainUs = 5'000'000, kReducedAgainUs = 60'000'000;

  const ForceReasons& reasons_;
  NoForce reason_ = NoForce::kNone;
  std::uint64_t since_us_ = 0;
  /// The user knows that there is no force.
  bool notified_ = false;
  bool said_ = false;  ///< of reason_, since it began
  std::array<std::uint64_t, kNoForceNames.size()> said_us_{};
};

}  // namespace kerf::agent
