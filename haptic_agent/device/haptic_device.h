// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "kernel/math/wrench.h"

namespace kerf::agent {

/// How far a device has come. A force may be written in kReady only; before that every `write`
/// shows zero.
enum class DevicePhase : std::uint8_t {
  /// Not there, unplugged, or not allowed to be opened.
  kClosed,
  /// Opened and claimed; what it is has not been checked yet.
  kOpened,
  /// It is what it should be and speaks a known protocol version.
  kIdentified,
  /// It moves, or is to be moved, until it knows its own angles. Its pose means nothing yet.
  kHoming,
  /// Poses stream, forces may be shown.
  kReady,
};

/// What a device tells about the hand at one instant.
struct DeviceState {
  Vec3 tip_mm{};
  /// Unit, from the tip to the spindle.
  Vec3 axis{0, 0, 1};
  /// As wire::MotionSample::buttons.
  std::uint32_t buttons = 0;
  /// The tool that a program asks for; 0: the one that the user chose.
  std::uint32_t tool_id = 0;
  /// When the pose was measured, on the servo's clock.
  std::uint64_t time_us = 0;
  /// False: the device has no pose (yet); nothing is sent and no force may be shown.
  bool valid = false;
  /// True: the device has nothing more to show (a replay has ended).
  bool finished = false;
  DevicePhase phase = DevicePhase::kClosed;
};

struct DeviceCapabilities {
  std::string name{};
  int sensed_dof = 0;
  int actuated_dof = 0;
  /// What the motors can give for a moment; 0 for a device without motors.
  double max_force_n = 0;
  double max_torque_nmm = 0;
  /// What the motors can give for ever without getting too warm; 0: unknown.
  double continuous_force_n = 0;
  double continuous_torque_nmm = 0;
  /// What the device shows stably at 1 kHz; 0: unknown.
  double max_stiffness_n_per_mm = 0;
  double max_damping_n_s_per_mm = 0;
  /// The box that the tip can reach, in the session's coordinates; both corners equal: unknown.
  Vec3 workspace_min_mm{};
  Vec3 workspace_max_mm{};
  /// The device senses whether a hand holds it and says so by wire::kButtonDeadman. Without, that
  /// bit is always set in a valid state.
  bool has_deadman = false;
};

/// A hand-held device. Only the servo thread calls `read` and `write`; both return at once, neither
/// allocates nor waits: a USB device answers with the newest report that its own thread has
/// received.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;

  virtual DeviceCapabilities capabilities() const = 0;
  /// The newest pose. `now_us` is the servo's clock and never goes back.
  virtual DeviceState read(std::uint64_t now_us) noexcept = 0;
  /// Shows a wrench until the next call; zero if the device is not ready. A device with a thread of
  /// its own takes the motors to zero by itself if no further call comes within kWrenchLifeUs.
  virtual void write(const Wrench& wrench) noexcept = 0;
  /// No force, at once, until the next `write`. From any thread: the watchdog calls it when the
  /// servo thread no longer does anything.
  virtual void stop() noexcept = 0;
  /// What keeps the device from being ready, in one sentence; empty: nothing does. From any thread
  /// but the servo's, for it may wait and allocate.
  virtual std::string trouble() const { return {}; }
};

/// How long a written wrench is shown by a device that has a thread of its own.
inline constexpr std::uint64_t kWrenchLifeUs = 10'000;

}  // namespace kerf::agent
