// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "haptic_agent/servo/output_stage.h"
#include "haptic_agent/servo/velocity_estimator.h"

namespace kerf::agent {

/// Simulation of a device of 0.1 kg held by a human hand, a network that sends adversarial
/// wrenches, and the output stage between them, in steps of 1 ms.
template <typename Deficit>
class Adversary {
 public:
  explicit Adversary(std::uint32_t seed)
      : random_(seed), kind_(seed % 6), quantum_mm_(seed % 2 == 0 ? 0 : 0.03) {
    hand_n_per_mm_ = uniform(0.005, 0.3);
    hand_n_s_per_mm_ = uniform(0, 0.002);
    hand_hz_ = uniform(0.3, 4);
    hand_mm_ = uniform(2, 40);
    strong_ = uniform(2, 30);
  }

  /// Returns the maximum work done on the hand over any interval, mJ, as measured by the encoders.
  double run(int ticks) {
    for (int tick = 0; tick < ticks; ++tick) step(tick * kTickS);
    return stage_.passivity().account().most_returned_mj();
  }
  /// The wrench was always finite and within its limits.
  bool kept_limits() const { return kept_limits_; }

 private:
  static constexpr double kTickS = 0.001;
  static constexpr double kMassKg = 0.1, kInertiaKgMm2 = 100;  // radius of gyration 30 mm

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
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

  void step(double time_s) {
    const Grip seen = measured();
    const Twist moved = between(seen_, seen);
    seen_ = seen;
    stage_.settle(moved);
    const Twist velocity = estimate_.take(moved, kTickS);
    const Wrench output = stage_.release(request(time_s, velocity), velocity, kTickS);
    kept_limits_ = kept_limits_ && is_finite(output) && length(output.force_n) <= 8 * (1 + 1e-12) &&
                   length(output.torque_nmm) <= 150 * (1 + 1e-12);
    if (static_cast<int>(uniform(0, 150)) == 0) jerk_ = any(uniform(0, 20));
    const double swing = hand_mm_ * std::sin(2 * std::numbers::pi * hand_hz_ * time_s);
    const Vec3 goal{swing, swing / 3, -swing / 2};
    jerk_ = jerk_ * 0.95;
    const Vec3 hand = (goal - at_.pivot_mm) * hand_n_per_mm_ - v_.linear * hand_n_s_per_mm_ + jerk_;
    v_.linear = v_.linear + (output.force_n + hand) * (1000 / kMassKg * kTickS);
    v_.angular = v_.angular +
                 (output.torque_nmm + jerk_ * 5 - v_.angular * 2) * (1000 / kInertiaKgMm2 * kTickS);
    v_.angular = v_.angular - at_.axis * dot(at_.axis, v_.angular);
    at_.pivot_mm = at_.pivot_mm + v_.linear * kTickS;
    at_.axis = normalized(rotated(at_.axis, v_.angular * kTickS));
  }

  std::mt19937 random_;
  std::uint32_t kind_;
  double quantum_mm_;
  double hand_n_per_mm_, hand_n_s_per_mm_, hand_hz_, hand_mm_, strong_;
  BasicOutputStage<Deficit> stage_{PassivitySettings{}, WrenchLimits{}};
  VelocityEstimator estimate_{100};
  Grip at_, seen_;
  Twist v_, late_;
  Wrench random_wrench_;
  Vec3 jerk_;
  int ticks_since_ = 0;
  bool kept_limits_ = true;
};

/// Worst result of several traces.
struct WorstReturn {
  double returned_mj = 0;
  std::uint32_t seed = 0;
  bool kept_limits = true;
};

template <typename Deficit>
WorstReturn worst_return(std::uint32_t first_seed, std::uint32_t traces, int ticks) {
  WorstReturn worst;
  for (std::uint32_t seed = first_seed; seed < first_seed + traces; ++seed) {
    Adversary<Deficit> adversary(seed);
    const double returned = adversary.run(ticks);
    worst.kept_limits = worst.kept_limits && adversary.kept_limits();
    if (returned > worst.returned_mj) {
      worst.returned_mj = returned;
      worst.seed = seed;
    }
  }
  return worst;
}

/// Invalid policy, for comparison: forgives a deficit.
struct ForgiveDeficit {
  static double keep(double level_mj) { return std::max(level_mj, 0.0); }
};

}  // namespace kerf::agent
