// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "kernel/math/wrench.h"

namespace kerf::agent {

/// Connection state of a device. `write` outputs a force only in kReady; in all other phases the
/// output is zero.
enum class DevicePhase : std::uint8_t {
  /// Not found, unplugged, or not permitted to be opened.
  kClosed,
  /// Opened and claimed, not identified yet.
  kOpened,
  /// Identified, with a supported protocol version; also during a fault of the device itself.
  kIdentified,
  /// Moves, or must be moved by the user, until its joint angles are known. The pose is not valid.
  kHoming,
  /// Sends poses and accepts forces.
  kReady,
};

/// Bits of DeviceState::buttons that are not part of the protocol. A press undoes the user's newest
/// stroke, or redoes the last undone one. The link removes these bits from the samples.
inline constexpr std::uint32_t kButtonUndo = 256;
inline constexpr std::uint32_t kButtonRedo = 512;
/// A press re-arms after a trip. The servo removes the bit.
inline constexpr std::uint32_t kButtonRearm = 1024;
/// While held, the tool stays in the block and the hand moves back. The servo removes the bit.
inline constexpr std::uint32_t kButtonClutch = 2048;

/// A pose and its context, as read from a device.
struct DeviceState {
  Vec3 tip_mm{};
  /// Unit vector from the tip to the spindle.
  Vec3 axis{0, 0, 1};
  /// Bits of wire::MotionSample::buttons, and kButtonUndo, kButtonRedo, kButtonRearm,
  /// kButtonClutch.
  std::uint32_t buttons = 0;
  /// The tool requested by a path, or 0 for the tool that the user chose.
  std::uint32_t tool_id = 0;
  /// Time of measurement, on the servo's clock.
  std::uint64_t time_us = 0;
  /// False while there is no pose: no sample is sent and no force is output.
  bool valid = false;
  /// True at the end of a path.
  bool finished = false;
  DevicePhase phase = DevicePhase::kClosed;
};

struct DeviceCapabilities {
  std::string name{};
  int sensed_dof = 0;
  int actuated_dof = 0;
  /// Peak rating, or 0 for a device without motors.
  double max_force_n = 0;
  double max_torque_nmm = 0;
  /// Continuous rating, or 0 if unknown.
  double continuous_force_n = 0;
  double continuous_torque_nmm = 0;
  /// Stiffness and damping that the device renders stably at 1 kHz, or 0 if unknown.
  double max_stiffness_n_per_mm = 0;
  double max_damping_n_s_per_mm = 0;
  /// Greatest frequency of a vibration that the motors render, or 0 if unknown: limited by the loop
  /// only.
  double max_vibration_hz = 0;
  /// Greatest time from the measurement of a pose until a wrench computed from it acts, in addition
  /// to the loop's period: transfers in both directions, drivers, current control.
  std::uint64_t latency_us = 0;
  /// Quantum of the measured tip and axis: poses are approximate multiples of it. If 0 (unknown),
  /// the servo finds it from the poses.
  double resolution_mm = 0;
  double resolution_rad = 0;
  /// Least mass that a force at the pivot moves, and least inertia about the pivot across the
  /// tool's axis, for the device alone, because a user may let it go. 0 if unknown.
  double moving_mass_kg = 0;
  double moving_inertia_kg_m2 = 0;
  /// Workspace of the tip, in session coordinates; unknown if both corners are equal.
  Vec3 workspace_min_mm{};
  Vec3 workspace_max_mm{};
  /// Whether the device senses that the user holds it, and reports it as wire::kButtonDeadman.
  /// Otherwise that bit is set in every valid state.
  bool has_deadman = false;
  /// The device has no cutting button. The tool cuts whenever force is permitted; without motors,
  /// always.
  bool always_cut = false;
};

/// Returns a wrench without the components for which a device has no motors: zero without a rated
/// force, no torque without a rated torque.
inline Wrench rated(const Wrench& wrench, const DeviceCapabilities& device) noexcept {
  if (!(device.max_force_n > 0)) return {};
  return {.force_n = wrench.force_n,
          .torque_nmm = device.max_torque_nmm > 0 ? wrench.torque_nmm : Vec3{}};
}

/// Measured time from the computation of a command until the arrival of the device's report that it
/// was accepted: both transfers, and up to one period of the device. It excludes the subsequent
/// current control of the motors.
struct CommandEcho {
  std::uint64_t count = 0;  ///< 0 if the device acknowledges no commands, or none yet
  std::uint64_t mean_us = 0;
  std::uint64_t most_us = 0;
};

/// A hand-held device. Only the servo thread calls `read` and `write`, which neither wait nor
/// allocate. A USB device returns the newest report that its event thread has received.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;

  virtual DeviceCapabilities capabilities() const = 0;
  /// Returns the newest pose. `now_us` is the servo's monotonic clock.
  virtual DeviceState read(std::uint64_t now_us) noexcept = 0;
  /// Outputs a wrench until the next call, or zero if the device is not ready. A device with its
  /// own thread sets the motors to zero if the next call does not come within kWrenchLifeUs.
  virtual void write(const Wrench& wrench) noexcept = 0;
  /// Tells the device before each `write` whether forces are permitted in this tick, as a hint for
  /// its user. They are not permitted before arming or after a trip.
  virtual void show_force(bool on) noexcept { static_cast<void>(on); }
  /// Sets the force to zero immediately, until the next `write`. Callable from any thread: the
  /// watchdog calls it when the servo thread hangs.
  virtual void stop() noexcept = 0;
  /// Returns the reason why the device is not ready, as one sentence. Empty if there is none.
  /// Callable from any thread except the servo's, because it may wait and allocate.
  virtual std::string trouble() const { return {}; }
  /// Callable from any thread.
  virtual CommandEcho command_echo() const noexcept { return {}; }
};

/// How long a device with its own thread outputs a written wrench.
inline constexpr std::uint64_t kWrenchLifeUs = 10'000;

}  // namespace kerf::agent
