// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/simulated_hand.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "haptic_agent/device/encoder.h"
#include "haptic_agent/device/units.h"
#include "server/wire/types.h"

namespace kerf::agent {
namespace {

/// Integration step: the servo's period, far below the stability limit.
constexpr double kStepS = 0.001;
/// Longest time simulated by one read. After a longer pause of the loop, for example while the
/// machine was suspended, the hand has not moved.
constexpr double kLongestGapS = 0.05;
/// Time spent at the end of the path, so that the last results arrive.
constexpr double kRestAtEndS = 0.3;

}  // namespace

SimulatedHand::SimulatedHand(PathCursor path, const HandSettings& settings)
    : path_(std::move(path)),
      settings_(settings),
      // c = 2 sqrt(k m), in N s/mm with k in N/mm and m in kg: sqrt(k/1000 * m).
      damping_n_s_per_mm_(2.0 *
                          std::sqrt(settings.stiffness_n_per_mm * settings.mass_kg / kMmPerM)),
      turn_damping_nmm_s_per_rad_(2.0 * std::sqrt(settings.turn_stiffness_nmm_per_rad *
                                                  settings.inertia_kg_m2 * kNmmPerNm)),
      target_(path_.at(0)),
      pivot_mm_(target_.tip_mm + target_.axis * settings.pivot_mm),
      axis_(target_.axis),
      path_s_(-settings.rest_at_start_s) {}

DeviceCapabilities SimulatedHand::capabilities() const {
  return {.name = "simulated hand",
          .sensed_dof = 5,
          .actuated_dof = 5,
          .max_force_n = 15.0,
          .max_torque_nmm = 500.0,
          .resolution_mm = settings_.quantum_mm,
          .resolution_rad = settings_.quantum_rad,
          .moving_mass_kg = settings_.mass_kg,
          .moving_inertia_kg_m2 = settings_.inertia_kg_m2,
          .has_deadman = true};
}

void SimulatedHand::write(const Wrench& wrench) noexcept {
  stopped_.store(false, std::memory_order_release);
  wrench_ = wrench;
}

DeviceState SimulatedHand::read(std::uint64_t now_us) noexcept {
  if (!started_) {
    started_ = true;
    last_us_ = now_us;
  }
  const double passed_s = static_cast<double>(now_us - last_us_) * kSPerUs;
  last_us_ = now_us;
  if (stopped_.load(std::memory_order_acquire)) wrench_ = {};
  bool cutting = false;
  for (double left_s = std::min(passed_s, kLongestGapS); left_s > 0; left_s -= kStepS) {
    step(std::min(left_s, kStepS));
    cutting = cutting || target_.cutting;
  }
  const std::uint32_t held = act_ == Regrip::Act::kLetGo ? 0U : wire::kButtonDeadman;
  const Vec3 tip_mm = pivot_mm_ - axis_ * settings_.pivot_mm;
  max_deviation_mm_ = std::max(max_deviation_mm_, length(tip_mm - target_.tip_mm));
  return {.tip_mm = rounded(tip_mm, settings_.quantum_mm),
          .axis = normalized(rounded(axis_, settings_.quantum_rad)),
          .buttons = held | (cutting ? wire::kButtonCutting : 0U),
          .tool_id = target_.tool_id,
          .time_us = now_us,
          .valid = true,
          .finished = rested_s_ >= kRestAtEndS,
          .phase = DevicePhase::kReady};
}

void SimulatedHand::step(double dt_s) noexcept {
  const double arm_mm = settings_.pivot_mm;
  const Vec3 goal_mm = target_.tip_mm + target_.axis * arm_mm;
  const Vec3 goal_mm_per_s =
      target_.tip_mm_per_s + cross(target_.turn_rad_per_s, target_.axis) * arm_mm;

  const Vec3 pull_n = (goal_mm - pivot_mm_) * settings_.stiffness_n_per_mm +
                      (goal_mm_per_s - pivot_mm_per_s_) * damping_n_s_per_mm_;
  const Vec3 force_n = pull_n + wrench_.force_n;
  pivot_mm_per_s_ = pivot_mm_per_s_ + force_n * (kMmPerM / settings_.mass_kg * dt_s);
  pivot_mm_ = pivot_mm_ + pivot_mm_per_s_ * dt_s;

  // Rotation vector from the axis to its target, approximated by the sine. It has no component
  // about the tool's own axis.
  const Vec3 error_rad = cross(axis_, target_.axis);
  const Vec3 pull_nmm = error_rad * settings_.turn_stiffness_nmm_per_rad +
                        (target_.turn_rad_per_s - turn_rad_per_s_) * turn_damping_nmm_s_per_rad_;
  Vec3 torque_nmm = pull_nmm + wrench_.torque_nmm;
  torque_nmm = torque_nmm - axis_ * dot(axis_, torque_nmm);
  turn_rad_per_s_ =
      turn_rad_per_s_ + torque_nmm * (1.0 / (settings_.inertia_kg_m2 * kNmmPerNm) * dt_s);
  turn_rad_per_s_ = turn_rad_per_s_ - axis_ * dot(axis_, turn_rad_per_s_);
  axis_ = normalized(axis_ + cross(turn_rad_per_s_, axis_) * dt_s);

  follow_path(dt_s);
}

/// Moves the target along the path, or rests on it. The cutting button keeps its state: while
/// pressed, the tool does not push its own cut aside, and it can be armed at rest.
void SimulatedHand::follow_path(double dt_s) noexcept {
  act_ = regrip_.step(force_on_, dt_s);
  if (act_ == Regrip::Act::kWork) {
    path_s_ += dt_s;
    target_ = path_.at(std::max(0.0, path_s_));
  } else {
    target_.tip_mm_per_s = target_.turn_rad_per_s = {};
  }
  if (target_.at_end) rested_s_ += dt_s;
}

}  // namespace kerf::agent
