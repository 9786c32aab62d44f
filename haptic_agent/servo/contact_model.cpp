// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/contact_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf::agent {

Wrench ContactModel::push(const Grip& now, double max_stiffness) const noexcept {
  Wrench sum;
  const Vec3 turn = between(then_, now).angular;
  for (std::uint32_t i = 0; i < answer_.plane_count; ++i) {
    const wire::ContactPlane& plane = answer_.planes[i];
    if ((plane.flags & flags_) == 0) continue;
    const Vec3 arm = rotated(plane.point_mm - then_.pivot_mm, turn);
    const Vec3 moved = now.pivot_mm + arm - plane.point_mm;
    const Vec3 normal(plane.normal);
    const double depth = static_cast<double>(plane.depth_mm) - dot(normal, moved);
    // Beyond its radius the plane's force fades to zero over another radius.
    const double fade =
        std::clamp(2 - length(moved) / static_cast<double>(plane.radius_mm), 0.0, 1.0);
    if (!(depth > 0) || !(fade > 0)) continue;
    const double stiffness = std::min(static_cast<double>(plane.stiffness_n_per_mm), max_stiffness);
    const Vec3 force = normal * (stiffness * depth * fade);
    sum = sum + Wrench{force, cross(arm, force)};
  }
  sum.torque_nmm = sum.torque_nmm - now.axis * dot(sum.torque_nmm, now.axis);
  return sum;
}

void ContactModel::take(const ServerWrench& answer, const Grip& then, const Grip& now) noexcept {
  const Wrench before = push(now, max_stiffness_) + fading_;
  answer_ = answer;
  then_ = then;
  fading_ = before - push(now, max_stiffness_);
}

Wrench ContactModel::at(const Grip& now, double dt_s) noexcept {
  fading_ = fading_ * std::exp(-dt_s / kFadeS);
  return push(now, max_stiffness_) + fading_;
}

Wrench ContactModel::in_answer() const noexcept {
  return push(then_, std::numeric_limits<double>::infinity());
}

}  // namespace kerf::agent
