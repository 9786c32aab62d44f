// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "haptic_agent/servo/output_stage.h"
#include "haptic_agent/servo/servo_cycle.h"
#include "haptic_agent/servo/velocity_estimator.h"

namespace kerf::agent {

/// Special cases and deliberate errors.
struct AdversaryFaults {
  /// No error: the pen turns as easily as the lightest one for which the bound is claimed.
  bool lightest_pen = false;
  /// The account assumes that a wrench acts when it is written.
  bool ignores_latency = false;
  /// The device declares 20 times its mass and inertia, so its motion differs much from the
  /// estimate.
  bool declares_too_much_mass = false;
  /// The damper of a deficit may exceed the limit above which a late damper of rotation oscillates.
  bool damps_turning_freely = false;
  /// A released wrench is not charged for turning a pen at rest.
  bool ignores_turning = false;
};

/// Simulation of a device in a human hand, a network that sends adversarial wrenches, a loop that
/// loses ticks, and the output stage between them. Wrenches act up to 3 ms after they are written.
/// The work on the hand is that of the acting wrench, integrated in steps of 0.125 ms, independent
/// of the stage's own account.
template <typename Deficit>
class Adversary {
 public:
  explicit Adversary(std::uint32_t seed, const AdversaryFaults& faults = {})
      : random_(seed), kind_(seed % 6), quantum_mm_(seed % 2 == 0 ? 0 : 0.03) {
    mass_kg_ = log_uniform(0.05, 2);
    inertia_kg_mm2_ = log_uniform(kLeastInertia, 1000);
    if (faults.lightest_pen) inertia_kg_mm2_ = kLeastInertia;
    latency_us_ = std::array<std::uint64_t, 4>{0, 1000, 2375, 3000}[seed / 6 % 4];
    hand_n_per_mm_ = log_uniform(0.005, 2);
    hand_n_s_per_mm_ =
        uniform(0, 1) * 2 * std::sqrt(hand_n_per_mm_ * mass_kg_ / kMmPerM);  // up to critical
    hand_hz_ = uniform(0.3, 4);
    hand_mm_ = uniform(2, 40);
    strong_ = uniform(2, 30);
    DeviceCapabilities device{.name = "adversary",
                              .max_force_n = 20,
                              .max_torque_nmm = 500,
                              .max_damping_n_s_per_mm = 0.06,
                              .latency_us = faults.ignores_latency ? 0 : latency_us_,
                              .moving_mass_kg = mass_kg_,
                              .moving_inertia_kg_m2 = inertia_kg_mm2_ / kMmPerM / kMmPerM};
    if (faults.declares_too_much_mass) {
      device.moving_mass_kg *= 20;
      device.moving_inertia_kg_m2 *= 20;
    }
    ServoSettings settings = settings_for(device, {});
    PassivitySettings& passivity = settings.passivity;
    if (faults.damps_turning_freely)
      passivity.max_turn_damping = PassivitySettings{}.max_turn_damping;
    if (faults.ignores_turning) passivity.inertia_kg_m2 = 1;
    limits_ = settings.limits;
    stage_ = BasicOutputStage<Deficit>(settings.passivity, settings.limits);
  }

  /// Returns the maximum work done on the hand over any interval, mJ.
  double run(int ticks) {
    for (int tick = 0; tick < ticks; ++tick) step();
    return most_returned_mj_;
  }
  /// Each wrench was finite, and within the limits of its size and rise.
  bool kept_limits() const { return kept_limits_; }

 private:
  static constexpr double kMmPerM = 1000;
  static constexpr double kLeastInertia = 10;  // kg mm²
  static constexpr std::uint64_t kTickUs = 1000, kStepUs = 125, kStartUs = 1'000'000;

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double log_uniform(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  Vec3 any(double most) {
    return {uniform(-most, most), uniform(-most, most), uniform(-most, most)};
  }

  Wrench request(double time_s, const Twist& v) {
    if (ticks_since_ == 0) random_wrench_ = {any(strong_), any(strong_ * 20)};
    ticks_since_ = (ticks_since_ + 1) % 7;
    const double speed = std::max(1e-9, length(v.linear)),
                 turning = std::max(1e-9, length(v.angular));
    const double wave = std::sin(2 * std::numbers::pi * 3 * time_s);
    switch (kind_) {
      case 0:
        return random_wrench_;
      case 1:  // pushes in the direction of motion
        return {v.linear * (strong_ / speed), v.angular * (20 * strong_ / turning)};
      case 2:
        return {Vec3{strong_ * wave, 0, 0}, Vec3{0, strong_ * 20 * wave, 0}};
      case 3:  // a damper with delay
        late_ = late_ * 0.97 + v * 0.03;
        return {late_.linear * -0.5, late_.angular * -500};
      case 4:  // dissipates for a while, then drives
        return time_s - std::floor(time_s / 0.3) * 0.3 < 0.2
                   ? Wrench{v.linear * -0.02, v.angular * -20}
                   : Wrench{v.linear * 10, v.angular * 10'000};
      default:  // reverses in each tick
        return random_wrench_ * (static_cast<int>(time_s * 1000) % 2 == 0 ? 1 : -1);
    }
  }

  Grip measured() const {
    const auto snap = [q = quantum_mm_](double x) { return q > 0 ? std::round(x / q) * q : x; };
    return {{snap(at_.pivot_mm.x), snap(at_.pivot_mm.y), snap(at_.pivot_mm.z)}, at_.axis};
  }

  /// One tick: after 1 ms, or up to 5 ms if ticks are lost, less than 2 % in all.
  void step() {
    const bool loses = uniform(0, 1) < 0.008;
    const auto ticks = loses ? static_cast<std::uint64_t>(uniform(2, 5.999)) : 1;
    if (static_cast<int>(uniform(0, 150)) == 0)
      jerk_ = any(uniform(0, std::min(20.0, 100 * mass_kg_)));
    jerk_ = jerk_ * 0.95;
    const std::uint64_t from_us = now_us_;
    while (now_us_ < from_us + ticks * kTickUs) move();
    const double dt_s = static_cast<double>(now_us_ - from_us) * 1e-6;
    const Grip seen = measured();
    const Twist moved = between(seen_, seen);
    seen_ = seen;
    stage_.settle(moved, from_us, now_us_);
    const Twist velocity = estimate_.take(moved, dt_s);
    const Wrench before = stage_.released();
    const double time_s = static_cast<double>(now_us_ - kStartUs) * 1e-6;
    // Like the supervisor: no force after the tip was too fast.
    tripped_ = tripped_ || length(velocity.linear) > SafetyLimits{}.tip_mm_per_s;
    const Wrench output =
        tripped_ ? stage_.silence(now_us_)
                 : stage_.release(request(time_s, velocity), velocity, moved, dt_s, now_us_);
    newest_ = (newest_ + 1) % written_.size();
    written_[newest_] = {now_us_, output};
    check(before, output, std::min(dt_s, 0.002));
  }

  /// Returns whether `now` may follow `before`: a share of it plus a limited rise.
  static bool may_follow(Vec3 before, Vec3 now, double rise) {
    const double square = dot(before, before);
    const double keep = square > 0 ? std::clamp(dot(now, before) / square, 0.0, 1.0) : 0;
    return length(now - before * keep) <= rise * (1 + 1e-9) + 1e-9;
  }
  void check(const Wrench& before, const Wrench& now, double dt_s) {
    kept_limits_ =
        kept_limits_ && is_finite(now) && length(now.force_n) <= limits_.force_n * (1 + 1e-12) &&
        length(now.torque_nmm) <= limits_.torque_nmm * (1 + 1e-12) &&
        may_follow(before.force_n, now.force_n, limits_.force_rise_n_per_s * dt_s) &&
        may_follow(before.torque_nmm, now.torque_nmm, limits_.torque_rise_nmm_per_s * dt_s);
  }

  const Wrench& acting() const {
    for (std::size_t age = 0; age < written_.size(); ++age) {
      const Written& w = written_[(newest_ + written_.size() - age) % written_.size()];
      if (w.time_us + latency_us_ <= now_us_) return w.wrench;
    }
    return written_[(newest_ + 1) % written_.size()].wrench;
  }

  void move() {
    const double dt = static_cast<double>(kStepUs) * 1e-6;
    const double time_s = static_cast<double>(now_us_ - kStartUs) * 1e-6;
    const double swing = hand_mm_ * std::sin(2 * std::numbers::pi * hand_hz_ * time_s);
    const Vec3 goal{swing, swing / 3, -swing / 2};
    const Vec3 hand = (goal - at_.pivot_mm) * hand_n_per_mm_ - v_.linear * hand_n_s_per_mm_ + jerk_;
    const Wrench& wrench = acting();
    v_.linear = v_.linear + (wrench.force_n + hand) * (kMmPerM / mass_kg_ * dt);
    v_.angular =
        v_.angular + (wrench.torque_nmm + jerk_ * (inertia_kg_mm2_ / 20) - v_.angular * 0.5) *
                         (kMmPerM / inertia_kg_mm2_ * dt);
    v_.angular = v_.angular - at_.axis * dot(at_.axis, v_.angular);
    at_.pivot_mm = at_.pivot_mm + v_.linear * dt;
    at_.axis = normalized(rotated(at_.axis, v_.angular * dt));
    given_mj_ += work(wrench, v_ * dt);
    least_given_mj_ = std::min(least_given_mj_, given_mj_);
    most_returned_mj_ = std::max(most_returned_mj_, given_mj_ - least_given_mj_);
    now_us_ += kStepUs;
  }

  struct Written {
    std::uint64_t time_us = 0;
    Wrench wrench{};
  };

  std::mt19937 random_;
  std::uint32_t kind_;
  double quantum_mm_;
  double mass_kg_, inertia_kg_mm2_;
  std::uint64_t latency_us_;
  double hand_n_per_mm_, hand_n_s_per_mm_, hand_hz_, hand_mm_, strong_;
  WrenchLimits limits_;
  BasicOutputStage<Deficit> stage_{PassivitySettings{}, WrenchLimits{}};
  VelocityEstimator estimate_{100};
  std::array<Written, 16> written_{};
  std::size_t newest_ = 0;
  std::uint64_t now_us_ = kStartUs;
  Grip at_, seen_;
  Twist v_, late_;
  Wrench random_wrench_;
  Vec3 jerk_;
  int ticks_since_ = 0;
  double given_mj_ = 0, least_given_mj_ = 0, most_returned_mj_ = 0;
  bool kept_limits_ = true, tripped_ = false;
};

/// Worst result of several traces.
struct WorstReturn {
  double returned_mj = 0;
  std::uint32_t seed = 0;
  bool kept_limits = true;
};

template <typename Deficit>
WorstReturn worst_return(std::uint32_t first_seed, std::uint32_t traces, int ticks,
                         const AdversaryFaults& faults = {}) {
  WorstReturn worst;
  for (std::uint32_t seed = first_seed; seed < first_seed + traces; ++seed) {
    Adversary<Deficit> adversary(seed, faults);
    const double returned = adversary.run(ticks);
    worst.kept_limits = worst.kept_limits && adversary.kept_limits();
    if (returned > worst.returned_mj) {
      worst.returned_mj = returned;
      worst.seed = seed;
    }
  }
  return worst;
}

/// Invalid policy for comparison: forgives a deficit.
struct ForgiveDeficit {
  static double keep(double level_mj) { return std::max(level_mj, 0.0); }
};

}  // namespace kerf::agent
