// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/force_watch.h"

#include <utility>

namespace kerf::agent {

std::string ForceWatch::look(NoForce reason, std::uint64_t now_us) {
  if (reason != reason_) {
    reason_ = reason;
    since_us_ = now_us;
    said_ = false;
  }
  if (reason == NoForce::kTripped) notified_ = true;
  // The user who holds the clutch knows the reason.
  const bool known = reason == NoForce::kArming || reason == NoForce::kClutched;
  if (reason == NoForce::kTripped || known) return {};
  if (!blocks(reason) && std::exchange(notified_, false)) return "the force is on";
  const bool blocked = blocks(reason);
  if (reason == NoForce::kNone || said_ ||
      now_us - since_us_ < (blocked ? kBlockedUs : kReducedUs)) {
    return {};
  }
  said_ = true;
  notified_ = notified_ || blocked;
  std::uint64_t& before_us = said_us_[static_cast<std::size_t>(reason)];
  if (before_us != 0 && now_us - before_us < (blocked ? kBlockedAgainUs : kReducedAgainUs)) {
    return {};
  }
  before_us = now_us;
  return (blocked ? "no force: " : "less force than computed: ") +
         reasons_.of(reason, TripCode::kNone);
}

}  // namespace kerf::agent
