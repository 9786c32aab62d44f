// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/servo/grip.h"
#include "haptic_agent/servo/server_wrench.h"

namespace kerf::agent {

/// Renders the contact planes of the newest answer as springs that act on the moving tool between
/// two answers. A difference between the planes of two answers fades in, so that a new answer never
/// causes a step of the force.
class ContactModel {
 public:
  /// Time constant with which a difference between two answers fades, s.
  static constexpr double kFadeS = 0.015;

  /// `max_stiffness`: upper limit of the springs, N/mm, which the device renders stably. Planes
  /// with none of `flags` (wire::ContactPlane) are ignored.
  explicit ContactModel(double max_stiffness,
                        std::uint32_t flags = wire::kContactStock | wire::kContactObstacle) noexcept
      : max_stiffness_(max_stiffness), flags_(flags) {}

  /// Sets the newest answer. `then`: the grip that it answers; `now`: the newest grip.
  void take(const ServerWrench& answer, const Grip& then, const Grip& now) noexcept;
  /// Returns force and torque about the pivot, `dt_s` after the last call.
  Wrench at(const Grip& now, double dt_s) noexcept;
  /// Returns the part of the answer's own wrench that these planes contribute.
  Wrench in_answer() const noexcept;

 private:
  Wrench push(const Grip& now, double max_stiffness) const noexcept;

  double max_stiffness_;
  std::uint32_t flags_;
  ServerWrench answer_;
  Grip then_;
  Wrench fading_;
};

}  // namespace kerf::agent
