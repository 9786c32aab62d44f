// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

#include "haptic_agent/servo/twist.h"

namespace kerf::agent {

/// The hand's velocity from its poses: finite differences through a first-order low-pass. A higher
/// cut-off follows faster and shows more of the encoders' steps; the best one belongs to a device
/// (Chawda et al., research on velocity filters), 50 to 100 Hz suit most.
class VelocityEstimator {
 public:
  /// `cutoff_hz` > 0.
  explicit VelocityEstimator(double cutoff_hz) noexcept
      : time_s_(1 / (2 * std::numbers::pi * cutoff_hz)) {}

  /// The hand has moved so in `dt_s`; gives the velocity now, mm/s and rad/s.
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
