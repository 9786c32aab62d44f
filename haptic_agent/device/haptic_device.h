#pragma once

#include <cstdint>
#include <string>

#include "haptic_agent/device/vec3.h"

namespace kerf::agent {

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
};

/// Force at the pivot and torque about it, as the device shows them to the hand.
struct Wrench {
  Vec3 force_n{};
  Vec3 torque_nmm{};

  bool operator==(const Wrench&) const = default;
};

struct DeviceCapabilities {
  std::string name{};
  int sensed_dof = 0;
  int actuated_dof = 0;
  /// What the motors can give; 0 for a device without motors.
  double max_force_n = 0;
  double max_torque_nmm = 0;
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
  /// Shows a wrench until the next call.
  virtual void write(const Wrench& wrench) noexcept = 0;
};

}  // namespace kerf::agent
