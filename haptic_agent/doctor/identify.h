// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <random>
#include <string>
#include <vector>

#include "haptic_agent/device/device_profile.h"
#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/doctor/finding.h"
#include "haptic_agent/doctor/motion_fit.h"
#include "haptic_agent/servo/grip.h"
#include "haptic_agent/servo/servo_loop.h"

namespace kerf::agent {

/// Greatest force, N, and torque, N mm, of an identification, each at most a fifth of the device's;
/// and the motion, mm of the pivot and rad of the axis, beyond which it ends with an error.
inline constexpr double kShakeN = 1, kShakeNmm = 20;
inline constexpr double kShakeMm = 10, kShakeRad = 0.15;
/// Duration for each of force and torque.
inline constexpr double kShakeS = 9;

/// Pushes a device to and fro along x and then, if it has torque, turns it about y, with steps of
/// random length whose strength grows until it moves by some millimeters. For a device that nobody
/// holds. One tick per millisecond; losing more than a hundredth of them is an error, because the
/// fit assumes equal ticks.
class Identification final : public ServoTask {
 public:
  /// `device` must outlive the object. `pivot_mm`: from the tip to the point where forces act.
  Identification(HapticDevice& device, double pivot_mm);

  /// Returns false when it has ended. The device's force is then zero.
  bool tick(std::uint64_t now_us) noexcept override;

  /// Returns the measured profile after the end, or the reason why there is none, as a sentence.
  std::expected<DeviceProfile, std::string> profile() const;
  /// The fits of force and torque. Call after `profile` had a value.
  const MotionFit& moved() const { return moved_; }

 private:
  /// The phase: a force moves the pivot along x, or a torque turns the axis about y.
  enum class Part : std::uint8_t { kForce, kTorque, kEnd };
  struct Shake {
    std::vector<MotionRecord> motion{}, tip{};
    double strength = 0;
  };
  void next(Part part) noexcept;
  double effort(double position, double least, double most, double range) noexcept;
  void stop(const char* reason) noexcept;

  HapticDevice& device_;
  double pivot_mm_;
  DeviceCapabilities declared_;
  Part part_ = Part::kForce;
  std::uint64_t ticks_ = 0, absent_ = 0, last_us_ = 0, lost_ = 0;
  Grip from_{};
  Shake force_, torque_;
  std::minstd_rand random_{1};
  double sign_ = 1, before_ = 0, speed_ = 0, reached_ = 0;
  int hold_ = 0;
  const char* trouble_ = nullptr;
  mutable MotionFit moved_{};
};

/// Returns the warning to show before an identification moves the device.
std::string identification_warning(const DeviceCapabilities& device);

/// Compares each measured value with the declared one, and adds the stiffest walls.
std::vector<Finding> judge_profile(const DeviceCapabilities& declared,
                                   const DeviceProfile& profile);

}  // namespace kerf::agent
