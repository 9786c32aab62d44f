// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/servo/grip.h"
#include "haptic_agent/servo/lost_ticks.h"
#include "haptic_agent/servo/no_force.h"
#include "haptic_agent/servo/rearm_gesture.h"
#include "haptic_agent/servo/thermal.h"

namespace kerf::agent {

/// States of the safety supervisor.
enum class ServoPhase : std::uint8_t {
  /// No force. The deadman and a recent answer lead to kArmed.
  kReady,
  /// No force yet: the tip must be slow and the wrench small for a while.
  kArmed,
  /// The force gain rises from 0 to 1.
  kRamp,
  kActive,
  /// Like kActive, while the server is late, ticks are lost or the energy tank is empty.
  kDegraded,
  /// Tripped: no force until the user has let go of the device (Supervisor) and holds it again.
  kSafe,
};

/// Reason of a trip.
enum class TripCode : std::uint8_t {
  kNone,
  kDeviceLost,
  kNotFinite,
  kWorkspace,
  kJump,
  kSpeed,
  kTurnSpeed,
  kLostTicksInARow,
  kLostTicks,
  kThermalForce,
  kThermalTorque,
  kOverdrawn,
  kRejectedWrench,
};

inline constexpr std::array<std::string_view, 6> kPhaseNames = {"ready",  "armed",    "ramp",
                                                                "active", "degraded", "safe"};
inline constexpr std::array<std::string_view, 13> kTripNames = {"none",
                                                                "device_lost",
                                                                "pose_not_finite",
                                                                "out_of_workspace",
                                                                "pose_jump",
                                                                "tip_too_fast",
                                                                "turns_too_fast",
                                                                "lost_ticks_in_a_row",
                                                                "lost_ticks",
                                                                "force_too_long",
                                                                "torque_too_long",
                                                                "energy_overdrawn",
                                                                "wrench_not_finite"};
constexpr std::string_view to_string(ServoPhase phase) noexcept {
  return kPhaseNames[static_cast<std::size_t>(phase)];
}
constexpr std::string_view to_string(TripCode code) noexcept {
  return kTripNames[static_cast<std::size_t>(code)];
}

/// The safety envelope. All limits are active unless the device has no motors.
struct SafetyLimits {
  double tip_mm_per_s = 1000;
  double turn_rad_per_s = 15;
  double jump_mm = 5;  ///< displacement of the tip, per ms
  std::uint64_t lost_in_a_row = 5;
  double lost_share = 0.5;  ///< of the ticks in the last second
  /// 0 if unknown: not checked.
  double continuous_force_n = 0;
  double continuous_torque_nmm = 0;
  Vec3 workspace_min_mm{};
  Vec3 workspace_max_mm{};  ///< equal to the minimum if unknown: not checked
  double ramp_s = 0.5;
  /// The device senses that it is held. Without this sensor the user releases the cutting button to
  /// re-arm, or makes a RearmGesture.
  bool has_deadman = true;
  /// A device without motors needs no arming and cannot trip.
  bool motors = true;
};

/// Input of one tick.
struct SafetyInput {
  std::uint64_t now_us = 0;
  double dt_s = 0.001;
  bool present = true;  ///< the device is ready and has a pose
  bool finite = true;   ///< the pose is finite
  bool deadman = false;
  bool cutting = false;  ///< the cutting button is pressed
  DevicePhase device = DevicePhase::kReady;
  Vec3 tip_mm{};
  double jumped_mm = 0;  ///< displacement of the tip since the previous tick
  double tip_mm_per_s = 0;
  double turn_rad_per_s = 0;
  bool has_answer = false;
  std::uint64_t answer_age_us = 0;
  std::uint64_t lost_now = 0;  ///< ticks lost since the previous one
  Wrench requested{};          ///< before the gain is applied
  Wrench guided{};             ///< the guides' part of it, which does not prevent arming
  Wrench output{};             ///< of the previous tick
  bool starving = false;
  bool overdrawn = false;
  bool faded = false;     ///< the requested wrench was faded, because answers are old
  bool limited = false;   ///< the previous wrench was shortened to the limits of force and torque
  bool clutched = false;  ///< the clutch is held: the tool stays in the block
};

/// Decides in each tick whether force may be output, and with which gain: the ramp's times that of
/// LostTicks. A trip ends when the user has let go for 0.3 s: released the deadman or, on a device
/// without one, the cutting button, which must have been pressed since the trip. On such a device a
/// RearmGesture ends it too, and on any device a request (`rearm`).
class Supervisor {
 public:
  explicit Supervisor(const SafetyLimits& limits) noexcept
      : limits_(limits), force_(limits.continuous_force_n), torque_(limits.continuous_torque_nmm) {}

  /// Returns the gain for this tick, 0 to 1.
  double tick(const SafetyInput& in) noexcept;

  /// Ends a trip in the next tick in which the device is present. No effect in other phases.
  void rearm() noexcept { asked_ = phase_ == ServoPhase::kSafe; }

  /// Why there is no force after the newest tick, or less than computed.
  NoForce no_force() const noexcept { return no_force_; }
  /// Factor of the force due to lost ticks.
  double lost_gain() const noexcept { return lost_.gain(); }

  ServoPhase phase() const noexcept { return phase_; }
  /// Code of the latest trip; kNone before the first trip.
  TripCode code() const noexcept { return code_; }
  std::uint64_t trips() const noexcept { return trips_; }
  /// Ticks in kDegraded.
  std::uint64_t degraded_ticks() const noexcept { return degraded_ticks_; }

 private:
  bool has_force() const noexcept {
    return phase_ >= ServoPhase::kRamp && phase_ < ServoPhase::kSafe;
  }
  TripCode fault(const SafetyInput& in) noexcept;
  void enter(ServoPhase phase, const SafetyInput& in) noexcept;
  void advance(const SafetyInput& in) noexcept;
  void monitor(const SafetyInput& in) noexcept;
  bool lets_go(const SafetyInput& in) noexcept;
  bool ends_trip(const SafetyInput& in) noexcept;
  void step(const SafetyInput& in) noexcept;
  NoForce why(const SafetyInput& in) const noexcept;
  static bool is_fresh(const SafetyInput& in) noexcept;
  static bool is_small(const SafetyInput& in) noexcept;
  static bool is_slow(const SafetyInput& in) noexcept;
  bool reaches(const SafetyInput& in) const noexcept;

  /// Lost ticks with a gain above this are not reported.
  static constexpr double kTellingGain = 0.98;

  SafetyLimits limits_;
  ThermalLoad force_, torque_;
  ServoPhase phase_ = ServoPhase::kReady;
  TripCode code_ = TripCode::kNone;
  std::uint64_t trips_ = 0;
  std::uint64_t since_us_ = 0;        ///< start of the phase
  std::uint64_t steady_from_us_ = 0;  ///< since when the phase's exit condition holds; 0 if not
  std::uint64_t starving_from_us_ = 0;
  bool pressed_ = false;  ///< the cutting button was pressed since the start of the phase
  std::uint64_t degraded_ticks_ = 0;
  LostTicks lost_;
  RearmGesture gesture_;
  bool asked_ = false;  ///< `rearm` was called in this kSafe
  NoForce no_force_ = NoForce::kAbsent;
};

}  // namespace kerf::agent
