// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/supervisor.h"

namespace kerf::agent {
namespace {

/// Returns why a device cannot be used; kNone if it can.
NoForce trouble_of(const SafetyInput& in) noexcept {
  if (in.present) return in.finite ? NoForce::kNone : NoForce::kFault;
  switch (in.device) {
    case DevicePhase::kHoming:
      return NoForce::kHoming;
    case DevicePhase::kOpened:
    case DevicePhase::kIdentified:
      return NoForce::kFault;
    default:
      return NoForce::kAbsent;
  }
}

}  // namespace

NoForce Supervisor::why(const SafetyInput& in) const noexcept {
  if (!limits_.motors) return NoForce::kNoMotors;
  if (phase_ == ServoPhase::kSafe) return NoForce::kTripped;
  if (!has_force()) {
    if (const NoForce trouble = trouble_of(in); trouble != NoForce::kNone) return trouble;
    if (!in.deadman) return NoForce::kNotHeld;
    if (!is_fresh(in)) return NoForce::kNoAnswer;
    if (!reaches(in)) return NoForce::kOutOfReach;
    if (!is_small(in)) return NoForce::kTouching;
    return is_slow(in) ? NoForce::kArming : NoForce::kMoving;
  }
  if (in.clutched) return NoForce::kClutched;
  if (phase_ == ServoPhase::kRamp) return NoForce::kArming;
  if (in.faded) return NoForce::kServerLate;
  if (lost_.gain() < kTellingGain) return NoForce::kTicksLost;
  if (in.starving) return NoForce::kTankEmpty;
  return in.limited ? NoForce::kLimited : NoForce::kNone;
}

}  // namespace kerf::agent
