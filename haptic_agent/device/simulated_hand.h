// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/device/path_cursor.h"
#include "haptic_agent/device/regrip.h"

namespace kerf::agent {

/// Mechanical parameters of the simulated hand. Damping is critical.
struct HandSettings {
  /// Mass of hand and device at the pivot.
  double mass_kg = 0.3;
  double stiffness_n_per_mm = 2.0;
  /// Inertia about the pivot.
  double inertia_kg_m2 = 2e-4;
  double turn_stiffness_nmm_per_rad = 1340.0;
  /// Distance from the tip along the axis to the pivot, where the hand holds the tool. Torques are
  /// about the pivot.
  double pivot_mm = 60.0;
  /// Quanta to which the device rounds tip and axis, or 0 for no rounding.
  double quantum_mm = 0, quantum_rad = 0;
  /// Time at the first pose, as a user waits until the device is armed.
  double rest_at_start_s = 0;
};

/// A simulated hand that follows a path: a mass and an inertia at the pivot, coupled to the path by
/// springs and dampers. Force and torque deflect it as they would a user's hand. While there is no
/// force it stops on its path and lets go (Regrip). 5 DOF: there is no rotation or torque about the
/// tool's own axis.
class SimulatedHand final : public HapticDevice {
 public:
  SimulatedHand(PathCursor path, const HandSettings& settings);

  DeviceCapabilities capabilities() const override;
  DeviceState read(std::uint64_t now_us) noexcept override;
  void write(const Wrench& wrench) noexcept override;
  void show_force(bool on) noexcept override { force_on_ = on; }
  void stop() noexcept override { stopped_.store(true, std::memory_order_release); }

  /// Largest deviation of the tip from the path.
  double max_deviation_mm() const noexcept { return max_deviation_mm_; }

 private:
  void step(double dt_s) noexcept;
  void follow_path(double dt_s) noexcept;

  PathCursor path_;
  HandSettings settings_;
  double damping_n_s_per_mm_;
  double turn_damping_nmm_s_per_rad_;
  Wrench wrench_;
  std::atomic<bool> stopped_{false};
  Regrip regrip_;
  Regrip::Act act_ = Regrip::Act::kWork;
  bool force_on_ = true;
  PathPoint target_;
  Vec3 pivot_mm_;
  Vec3 pivot_mm_per_s_;
  Vec3 axis_;
  Vec3 turn_rad_per_s_;
  bool started_ = false;
  std::uint64_t last_us_ = 0;
  double path_s_ = 0;
  double rested_s_ = 0;
  double max_deviation_mm_ = 0;
};

}  // namespace kerf::agent
