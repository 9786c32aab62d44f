// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <utility>

#include "haptic_agent/device/encoder.h"
#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/servo/grip.h"
#include "server/wire/types.h"

namespace kerf::agent {

/// Mechanics of a device in a hand, and the time from a written wrench to its action.
struct PlantMechanics {
  double mass_kg = 0.1;
  double inertia_kg_m2 = 1e-4;
  double hand_n_per_mm = 0.5;
  double hand_nmm_per_rad = 300;
  double damping_ratio = 1;  ///< of the hand and its rotation; 1 is critical
  std::uint64_t latency_us = 0;
  double pivot_mm = 60;
  Vec3 axis{0, 0, 1};                      ///< axis to which the hand turns the tool; unit
  double quantum_mm = 0, quantum_rad = 0;  ///< to which the device rounds tip and axis; declared
};

/// A device of five degrees of freedom, held by a spring-damper hand that follows a target. The
/// acting wrench is the one written `latency_us` ago. Its work is integrated in steps of 0.125 ms,
/// as the motors and the hand see it.
class Plant final : public HapticDevice {
 public:
  using Target = std::function<Vec3(double time_s)>;  ///< of the tip

  Plant(Target target, const PlantMechanics& mechanics, bool cutting)
      : target_(std::move(target)),
        m_(mechanics),
        buttons_(cutting ? wire::kButtonCutting : 0U),
        grip_{target_(0) + mechanics.axis * mechanics.pivot_mm, mechanics.axis} {}

  DeviceCapabilities capabilities() const override {
    return {.name = "plant",
            .sensed_dof = 5,
            .actuated_dof = 5,
            .max_force_n = 20,
            .max_torque_nmm = 500,
            .max_stiffness_n_per_mm = 3,
            .max_damping_n_s_per_mm = 0.06,
            .latency_us = declared_latency_us_.value_or(m_.latency_us),
            .resolution_mm = m_.quantum_mm,
            .resolution_rad = m_.quantum_rad,
            .moving_mass_kg = m_.mass_kg,
            .moving_inertia_kg_m2 = declared_inertia_kg_m2_.value_or(m_.inertia_kg_m2)};
  }
  DeviceState read(std::uint64_t now_us) noexcept override {
    if (start_us_ == 0) start_us_ = now_us_ = now_us;
    while (now_us_ < now_us) move();
    return {.tip_mm = rounded(tip(), m_.quantum_mm),
            .axis = normalized(rounded(grip_.axis, m_.quantum_rad)),
            .buttons = wire::kButtonDeadman | buttons_,
            .tool_id = tool_id_,
            .time_us = now_us,
            .valid = true,
            .phase = DevicePhase::kReady};
  }
  void write(const Wrench& wrench) noexcept override { written_.push_back({now_us_, wrench}); }
  void stop() noexcept override { write({}); }

  /// For experiments with a device that does not know its latency.
  void declare_latency(std::uint64_t latency_us) { declared_latency_us_ = latency_us; }
  /// For experiments with a device that does not know how easily it turns.
  void declare_inertia(double kg_m2) { declared_inertia_kg_m2_ = kg_m2; }
  /// Presses these buttons in addition to the deadman, and chooses a tool (0 for the servo's).
  void hold(std::uint32_t buttons, std::uint32_t tool_id) {
    buttons_ = buttons;
    tool_id_ = tool_id;
  }
  /// Starts to measure the tip's motion while the hand is at rest.
  void begin_rest() {
    square_sum_ = 0, steps_ = 0;
    rest_tip_ = tip();
    rest_given_mj_ = given_mj_;
  }
  /// Displacement of the tip since begin_rest, and the work of the device on the hand; negative if
  /// the hand has moved the device.
  double moved_at_rest_mm() const { return length(tip() - rest_tip_); }
  double given_at_rest_mj() const { return given_mj_ - rest_given_mj_; }
  /// Root mean square of the tip's speed since begin_rest, mm/s.
  double rms_mm_per_s() const { return steps_ > 0 ? std::sqrt(square_sum_ / steps_) : 0; }
  /// Greatest work done on the hand over any interval, mJ.
  double most_returned_mj() const { return most_returned_mj_; }
  Vec3 tip() const { return grip_.pivot_mm - grip_.axis * m_.pivot_mm; }
  Vec3 axis() const { return grip_.axis; }
  const Wrench& acting() const { return acting_; }

 private:
  static constexpr std::uint64_t kStepUs = 125;
  static constexpr double kMmPerM = 1000;

  void move() {
    while (!written_.empty() && written_.front().first + m_.latency_us <= now_us_) {
      acting_ = written_.front().second;
      written_.pop_front();
    }
    const double dt = kStepUs * 1e-6;
    const double time_s = static_cast<double>(now_us_ - start_us_) * 1e-6;
    const Vec3 goal = target_(time_s) + m_.axis * m_.pivot_mm;
    const double damping =
        2 * m_.damping_ratio * std::sqrt(m_.hand_n_per_mm * m_.mass_kg / kMmPerM);
    const Vec3 pull = (goal - grip_.pivot_mm) * m_.hand_n_per_mm - v_.linear * damping;
    v_.linear = v_.linear + (pull + acting_.force_n) * (kMmPerM / m_.mass_kg * dt);
    const double inertia = m_.inertia_kg_m2 * kMmPerM;  // N mm s^2
    const double turn_damping = 2 * m_.damping_ratio * std::sqrt(m_.hand_nmm_per_rad * inertia);
    const Vec3 twist = cross(grip_.axis, m_.axis) * m_.hand_nmm_per_rad - v_.angular * turn_damping;
    v_.angular = v_.angular + (twist + acting_.torque_nmm) * (dt / inertia);
    v_.angular = v_.angular - grip_.axis * dot(grip_.axis, v_.angular);
    grip_.pivot_mm = grip_.pivot_mm + v_.linear * dt;
    grip_.axis = normalized(rotated(grip_.axis, v_.angular * dt));
    account(work(acting_, v_ * dt), length(v_.at(grip_.axis * -m_.pivot_mm)));
    now_us_ += kStepUs;
  }
  void account(double work_mj, double speed) {
    given_mj_ += work_mj;
    least_given_mj_ = std::min(least_given_mj_, given_mj_);
    most_returned_mj_ = std::max(most_returned_mj_, given_mj_ - least_given_mj_);
    square_sum_ += speed * speed;
    ++steps_;
  }

  Target target_;
  PlantMechanics m_;
  std::uint32_t buttons_, tool_id_ = 0;
  std::optional<std::uint64_t> declared_latency_us_;
  std::optional<double> declared_inertia_kg_m2_;
  Grip grip_;
  Twist v_;
  Wrench acting_{};
  std::deque<std::pair<std::uint64_t, Wrench>> written_;
  std::uint64_t start_us_ = 0, now_us_ = 0;
  double given_mj_ = 0, least_given_mj_ = 0, most_returned_mj_ = 0, square_sum_ = 0;
  int steps_ = 0;
  Vec3 rest_tip_{};
  double rest_given_mj_ = 0;
};

}  // namespace kerf::agent
