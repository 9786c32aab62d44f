// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/servo/server_wrench.h"
#include "haptic_agent/servo/twist.h"

namespace kerf::agent {

/// The planes of one kind of the newest answer, as springs that move with the hand between two
/// answers. Other planes fade in: a change of the answer never makes a step of the force.
class ContactModel {
 public:
  /// A difference between two answers' planes vanishes with this time constant, s.
  static constexpr double kFadeS = 0.015;

  /// `stiffness_most` is what the device shows stably, N/mm. Planes without any of `flags`
  /// (wire::ContactPlane) are left out.
  explicit ContactModel(double stiffness_most,
                        std::uint32_t flags = wire::kContactStock | wire::kContactObstacle) noexcept
      : stiffness_most_(stiffness_most), flags_(flags) {}

  /// `then` is the hold that the answer answers, `now` the newest.
  void take(const ServerWrench& answer, const Hold& then, const Hold& now) noexcept;
  /// Force at the pivot and torque about it, `dt_s` after the last call.
  Wrench at(const Hold& now, double dt_s) noexcept;
  /// What the server's own wrench holds of these planes, where they were taken.
  Wrench in_answer() const noexcept;

 private:
  Wrench push(const Hold& now, double stiffness_most) const noexcept;

  double stiffness_most_;
  std::uint32_t flags_;
  ServerWrench answer_;
  Hold then_;
  Wrench fading_;
};

}  // namespace kerf::agent
