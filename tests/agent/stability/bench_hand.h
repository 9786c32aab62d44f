// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "haptic_agent/servo/grip.h"
#include "server/wire/types.h"

namespace kerf::agent {

/// Target position of the tip at a time after the start, s.
using TargetTip = std::function<Vec3(double)>;

/// Simulated device of 0.1 kg with little friction, pulled along a path by a soft spring. A light
/// device in a soft hand is the hardest case for stability under delay.
class BenchHand final : public HapticDevice {
 public:
  struct Mechanics {
    double mass_kg = 0.1;
    double friction_n_s_per_mm = 0.0005;
    double spring_n_per_mm = 0.02;
    double damper_n_s_per_mm = 0.001;
    double pivot_mm = 60;
  };
  BenchHand(TargetTip target, Mechanics mechanics)
      : target_(std::move(target)), m_(mechanics), tip_(target_(0)) {}

  DeviceCapabilities capabilities() const override {
    return {.name = "bench hand",
            .sensed_dof = 5,
            .actuated_dof = 3,
            .max_force_n = 20,
            .max_torque_nmm = 500,
            .max_stiffness_n_per_mm = 3,
            .max_damping_n_s_per_mm = 0.06};
  }
  DeviceState read(std::uint64_t now_us) noexcept override {
    if (start_us_ == 0) start_us_ = last_us_ = now_us;
    for (; last_us_ < now_us; last_us_ += 250) step(0.00025);
    fastest_ = std::max(fastest_, length(velocity_));
    return {.tip_mm = tip_,
            .buttons = wire::kButtonCutting | wire::kButtonDeadman,
            .time_us = now_us,
            .valid = true,
            .phase = DevicePhase::kReady};
  }
  void write(const Wrench& wrench) noexcept override { wrench_ = wrench; }
  void stop() noexcept override { wrench_ = {}; }

  /// Maximum speed of the tip so far, mm/s.
  double fastest() const { return fastest_; }
  Vec3 tip() const { return tip_; }

 private:
  void step(double dt) {
    const double time_s = static_cast<double>(last_us_ - start_us_) * 1e-6;
    const Vec3 goal = target_(time_s);
    const Vec3 pull = (goal - tip_) * m_.spring_n_per_mm -
                      velocity_ * (m_.damper_n_s_per_mm + m_.friction_n_s_per_mm);
    velocity_ = velocity_ + (pull + wrench_.force_n) * (1000 / m_.mass_kg * dt);
    tip_ = tip_ + velocity_ * dt;
  }

  TargetTip target_;
  Mechanics m_;
  Vec3 tip_, velocity_;
  Wrench wrench_;
  double fastest_ = 0;
  std::uint64_t start_us_ = 0, last_us_ = 0;
};

/// Replays recorded poses, one per tick, and stores the written wrench. Has the capabilities of a
/// device with motors.
class RecordedHand final : public HapticDevice {
 public:
  explicit RecordedHand(std::vector<DeviceState> poses) : poses_(std::move(poses)) {}
  DeviceCapabilities capabilities() const override {
    return {.name = "recorded hand",
            .max_force_n = 20,
            .max_torque_nmm = 500,
            .max_stiffness_n_per_mm = 3,
            .max_damping_n_s_per_mm = 0.06};
  }
  DeviceState read(std::uint64_t now_us) noexcept override {
    DeviceState state = poses_[std::min(tick_++, poses_.size() - 1)];
    state.time_us = now_us;
    return state;
  }
  void write(const Wrench& wrench) noexcept override { output = wrench; }
  void stop() noexcept override { output = {}; }

  Wrench output;

 private:
  std::vector<DeviceState> poses_;
  std::size_t tick_ = 0;
};

}  // namespace kerf::agent
