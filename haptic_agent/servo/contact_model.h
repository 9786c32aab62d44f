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

  /// `stiffness_most`: upper limit of the springs, N/mm, which the device renders stably. Planes
  /// with none of `flags` (wire::ContactPlane) are ignored.
  explicit ContactModel(double stiffness_most,
                        std::uint32_t flags = wire::kContactStock | wire::kContactObstacle) noexcept
      : stiffness_most_(stiffness_most), flags_(flags) {}

  /// Sets the newest answer. `then`: the grip that it answers; `now`: the newest grip.
  void take(const ServerWrench& answer, const Grip& then, const Grip& now) noexcept;
  /// Returns force and torque about the pivot, `dt_s` after the last call.
  Wrench at(const Grip& now, double dt_s) noexcept;
  /// Returns the part of the answer's own wrench that these planes contribute.
  Wrench in_answer() const noexcept;

 private:
  Wrench push(const Grip& now, double stiffness_most) const noexcept;

  double stiffness_most_;
  std::uint32_t flags_;
  ServerWrench answer_;
  Grip then_;
  Wrench fading_;
};

}  // namespace kerf::agent
