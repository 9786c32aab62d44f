// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace kerf::agent {

/// Why the user feels no force, or less than computed. kNone: all of it is felt.
enum class NoForce : std::uint8_t {
  kNone,
  // No force is permitted:
  kNoMotors,    ///< the device has none
  kAbsent,      ///< it is not connected, or has no pose
  kHoming,      ///< its pose is not known yet: homing, not calibrated
  kFault,       ///< it reports a fault, or is being identified
  kTripped,     ///< a safety limit tripped (TripCode); the user must re-arm
  kNotHeld,     ///< the deadman is not held
  kNoAnswer,    ///< the server has not answered yet, or not for a while
  kOutOfReach,  ///< the tip is outside the device's workspace
  kTouching,    ///< cannot arm: there is a force at the tip already
  kMoving,      ///< cannot arm: the tip is too fast
  kArming,      ///< the force is about to rise
  kClutched,    ///< the clutch is held: the tool stays while the hand moves
  // Force is permitted but reduced:
  kServerLate,  ///< it fades because answers are old
  kTicksLost,   ///< the loop loses ticks
  kTankEmpty,   ///< the energy account is empty
  kLimited,     ///< by the device's limit, or that of the options
};

inline constexpr std::array<std::string_view, 17> kNoForceNames = {
    "none",     "no_motors",   "absent",       "homing",     "fault",  "tripped",
    "not_held", "no_answer",   "out_of_reach", "touching",   "moving", "arming",
    "clutched", "server_late", "ticks_lost",   "tank_empty", "limited"};
constexpr std::string_view to_string(NoForce reason) noexcept {
  return kNoForceNames[static_cast<std::size_t>(reason)];
}

/// Whether the force is zero, not just reduced.
constexpr bool blocks(NoForce reason) noexcept {
  return reason != NoForce::kNone && reason < NoForce::kServerLate;
}

}  // namespace kerf::agent
