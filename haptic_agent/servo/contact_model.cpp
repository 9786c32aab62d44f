// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/contact_model.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "haptic_agent/device/units.h"

namespace kerf::agent {

namespace {

/// Shares of the limits at which oscillation would begin.
constexpr double kStiffnessShare = 0.8;
constexpr double kDampingShare = 0.5;

}  // namespace

double moved_mass(const ContactLimits& limits, Vec3 arm_mm, Vec3 normal) noexcept {
  if (!(limits.mass_kg > 0) || !(limits.inertia_kg_m2 > 0)) return 0;
  const Vec3 lever_m = cross(arm_mm, normal) * (1 / kMmPerM);
  return 1 / (1 / limits.mass_kg + dot(lever_m, lever_m) / limits.inertia_kg_m2);
}

ContactGains stable_gains(const ContactLimits& limits, double stiffness, Vec3 arm_mm, Vec3 normal,
                          double share) noexcept {
  double damping = limits.max_damping;
  const double mass = moved_mass(limits, arm_mm, normal);
  if (mass > 0)
    damping = std::min(damping, kDampingShare * mass / limits.velocity_delay_s / kMmPerM);
  const double stable = kStiffnessShare * damping / limits.force_delay_s;
  return {.stiffness = std::min({stiffness, limits.max_stiffness, share * stable}),
          .damping = share * damping};
}

ContactModel::Touches ContactModel::touches_at(const Grip& grip) const noexcept {
  Touches touches;
  if (answer_.plane_count == 0) return touches;
  const Vec3 turn = between(then_, grip).angular;
  for (std::uint32_t i = 0; i < answer_.plane_count; ++i) {
    const wire::ContactPlane& plane = answer_.planes[i];
    if ((plane.flags & flags_) == 0) continue;
    const Vec3 arm = rotated(plane.point_mm - then_.pivot_mm, turn);
    const Vec3 moved = grip.pivot_mm + arm - plane.point_mm;
    const double depth = static_cast<double>(plane.depth_mm) - dot(Vec3(plane.normal), moved);
    // Beyond its radius the plane's force fades to zero over another radius.
    const double fade =
        std::clamp(2 - length(moved) / static_cast<double>(plane.radius_mm), 0.0, 1.0);
    if (depth > 0 && fade > 0) touches.all[touches.count++] = {&plane, arm, depth, fade};
  }
  return touches;
}

template <typename Gains>
Wrench ContactModel::push(const Touches& touches, Vec3 axis, const Twist& velocity,
                          const Gains& gains) noexcept {
  const auto touched = std::span(touches.all).first(touches.count);
  double load = 0;
  for (const Touch& touch : touched) load += touch.depth_mm * touch.fade;
  Wrench sum;
  for (const Touch& touch : touched) {
    const Vec3 normal(touch.plane->normal);
    const ContactGains g = gains(*touch.plane, touch.arm_mm, touch.depth_mm * touch.fade / load);
    const double speed = dot(normal, velocity.at(touch.arm_mm));
    // A contact pushes and never pulls.
    const double newtons =
        std::max(0.0, g.stiffness * touch.depth_mm - g.damping * speed) * touch.fade;
    const Vec3 force = normal * newtons;
    sum = sum + Wrench{force, cross(touch.arm_mm, force)};
  }
  sum.torque_nmm = sum.torque_nmm - axis * dot(sum.torque_nmm, axis);
  return sum;
}

Wrench ContactModel::damped(const Touches& touches, Vec3 axis,
                            const Twist& velocity) const noexcept {
  return push(touches, axis, velocity,
              [this](const wire::ContactPlane& plane, Vec3 arm_mm, double share) {
                return stable_gains(limits_, static_cast<double>(plane.stiffness_n_per_mm), arm_mm,
                                    Vec3(plane.normal), share);
              });
}

Wrench ContactModel::undamped(const Touches& touches, Vec3 axis) noexcept {
  return push(touches, axis, {}, [](const wire::ContactPlane& plane, Vec3, double) {
    return ContactGains{.stiffness = static_cast<double>(plane.stiffness_n_per_mm)};
  });
}

void ContactModel::take(const ServerWrench& answer, const Grip& then, const Grip& now,
                        const Twist& velocity) noexcept {
  const Wrench before = damped(touches_at(now), now.axis, velocity) + fading_;
  answer_ = answer;
  then_ = then;
  fading_ = before - damped(touches_at(now), now.axis, velocity);
}

Wrench ContactModel::at(const Grip& now, const Twist& velocity, double dt_s) noexcept {
  fading_ = fading_ * std::exp(-dt_s / kFadeS);
  const Touches touches = touches_at(now);
  computed_ = undamped(touches, now.axis);
  return damped(touches, now.axis, velocity) + fading_;
}

Wrench ContactModel::in_answer() const noexcept { return undamped(touches_at(then_), then_.axis); }

}  // namespace kerf::agent
