// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

#include "haptic_agent/servo/grip.h"

namespace kerf::agent {

/// Estimates the device's velocity from its poses: finite differences and a first-order low-pass
/// filter. A higher cut-off frequency follows faster and passes more of the encoder quantization.
/// The best value depends on the device; 50 to 100 Hz suit most (Chawda et al., on velocity
/// filters).
class VelocityEstimator {
 public:
  /// `cutoff_hz` > 0.
  explicit VelocityEstimator(double cutoff_hz) noexcept
      : time_s_(1 / (2 * std::numbers::pi * cutoff_hz)) {}

  /// Adds a displacement over `dt_s`. Returns the velocity, mm/s and rad/s.
  const Twist& take(const Twist& moved, double dt_s) noexcept {
    if (!(dt_s > 0)) return velocity_;
    const double part = dt_s / (time_s_ + dt_s);
    velocity_ = velocity_ * (1 - part) + moved * (part / dt_s);
    return velocity_;
  }
  void reset() noexcept { velocity_ = {}; }
  const Twist& velocity() const noexcept { return velocity_; }

 private:
  double time_s_;
  Twist velocity_;
};

}  // namespace kerf::agent
