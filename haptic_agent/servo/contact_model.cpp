// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/contact_model.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "haptic_agent/device/units.h"

namespace kerf::agent {

namespace {

/// Share of the stiffness limit that is used; at the limit oscillation begins.
constexpr double kStiffnessShare = 0.8;
/// Share of mass / delay that a damper gets. The more promptly the spring acts than the damper, the
/// larger the share.
constexpr double kDampingShare = 0.4, kDampingSlope = 0.1;
/// A difference between two answers fades over this many times the answer's age, s. Where a contact
/// moves on the tool, the difference is stiffness that acts late and drives the tool.
constexpr double kFadeAges = 2;
constexpr double kLeastFadeS = 0.002;
/// A difference above this, N, is a contact that appears or ends. It fades slowly.
constexpr double kStepN = 0.2;
/// Friction of a tool on a surface, as a share of the normal force: that of steel on greased steel
/// or dry wax. It is viscous up to the device's stable damping, so that it ends with the motion.
constexpr double kFriction = 0.1;

}  // namespace

double moved_mass(const ContactLimits& limits, Vec3 arm_mm, Vec3 normal) noexcept {
  if (!(limits.mass_kg > 0) || !(limits.inertia_kg_m2 > 0)) return 0;
  const Vec3 lever_m = cross(arm_mm, normal) * (1 / kMmPerM);
  return 1 / (1 / limits.mass_kg + dot(lever_m, lever_m) / limits.inertia_kg_m2);
}

double best_damping(const ContactLimits& limits, double mass) noexcept {
  return (kDampingShare / limits.velocity_delay_s + kDampingSlope / limits.force_delay_s) * mass;
}

double stable_stiffness(const ContactLimits& limits, double mass, double damping) noexcept {
  const double late = limits.force_delay_s, later = limits.velocity_delay_s;
  double stable = damping / late;
  if (mass > 0) {
    // For a free mass with its best damper: found by simulation, within a tenth.
    const double free = 0.25 * (1 + late / later) / (late * later);
    // With a weaker damper the limit falls no faster than the damper. The damper acts late and so
    // takes a part b of the mass: K <= B / (late + later b / (2 (1 - b))) for small b.
    const double b = damping * later / mass;
    constexpr double kHalf = 0.5;
    const double weak = b < 1 ? damping / (late + kHalf * later * b / (1 - b)) : 0;
    const double falling = free * mass * damping / best_damping(limits, mass);
    stable = std::min({stable, free * mass, std::max(falling, weak)});
  }
  return kStiffnessShare * stable;
}

ContactGains stable_gains(const ContactLimits& limits, double stiffness, Vec3 arm_mm, Vec3 normal,
                          double share) noexcept {
  const double mass = moved_mass(limits, arm_mm, normal) / kMmPerM;
  double damping = limits.max_damping;
  if (mass > 0) damping = std::min(damping, best_damping(limits, mass));
  const double stable = share * stable_stiffness(limits, mass, damping);
  return {.stiffness = std::min({stiffness, limits.max_stiffness, stable}),
          .damping = share * damping};
}

ContactModel::Touches ContactModel::touches_at(const Grip& grip) const noexcept {
  Touches touches;
  if (answer_.plane_count == 0) return touches;
  const Vec3 turn = between(then_, grip).angular;
  for (std::uint32_t i = 0; i < answer_.plane_count; ++i) {
    const wire::ContactPlane& plane = answer_.planes[i];
    if ((plane.flags & flags_) == 0) continue;
    if ((plane.flags & wire::kContactContinues) == 0 || touches.contacts == 0) ++touches.contacts;
    const std::uint32_t contact = touches.contacts - 1;
    touches.points[contact] += 1;
    const Vec3 arm = rotated(plane.point_mm - then_.pivot_mm, turn);
    const Vec3 moved = grip.pivot_mm + arm - plane.point_mm;
    const double depth = static_cast<double>(plane.depth_mm) - dot(Vec3(plane.normal), moved);
    // Beyond its radius the plane's force fades to zero over another radius.
    const double fade =
        std::clamp(2 - length(moved) / static_cast<double>(plane.radius_mm), 0.0, 1.0);
    if (!(depth > 0) || !(fade > 0)) continue;
    touches.all[touches.count++] = {&plane, arm, depth, fade, contact};
    touches.depths_mm[contact] += depth * fade;
  }
  return touches;
}

template <typename Gains>
Wrench ContactModel::push(const Touches& touches, Vec3 axis, const Twist& velocity,
                          const Gains& gains) noexcept {
  const auto touched = std::span(touches.all).first(touches.count);
  const auto load_of = [&](std::uint32_t c) { return touches.depths_mm[c] / touches.points[c]; };
  double load = 0;
  for (std::uint32_t c = 0; c < touches.contacts; ++c) load += load_of(c);
  Wrench sum;
  for (const Touch& touch : touched) {
    const Vec3 normal(touch.plane->normal);
    const auto along = [&](Vec3 direction) {
      return gains(*touch.plane, touch.arm_mm, direction, load_of(touch.contact) / load,
                   touches.points[touch.contact]);
    };
    const ContactGains g = along(normal);
    const Vec3 moves = velocity.at(touch.arm_mm);
    const double speed = dot(normal, moves);
    // A contact pushes and never pulls.
    const double newtons =
        std::max(0.0, g.stiffness * touch.depth_mm - g.damping * speed) * touch.fade;
    const Vec3 slides = moves - normal * speed;
    const double slip = length(slides);
    const double drag =
        slip > 0 ? std::min(kFriction * newtons / slip, along(slides * (1 / slip)).damping) : 0;
    const Vec3 force = normal * newtons - slides * drag;
    sum = sum + Wrench{force, cross(touch.arm_mm, force)};
  }
  sum.torque_nmm = sum.torque_nmm - axis * dot(sum.torque_nmm, axis);
  return sum;
}

Wrench ContactModel::damped(const Touches& touches, Vec3 axis,
                            const Twist& velocity) const noexcept {
  return push(touches, axis, velocity,
              [this](const wire::ContactPlane& plane, Vec3 arm_mm, Vec3 direction, double share,
                     double points) {
                ContactLimits limits = limits_;
                limits.max_stiffness /= points;
                return stable_gains(limits, static_cast<double>(plane.stiffness_n_per_mm), arm_mm,
                                    direction, share / points);
              });
}

Wrench ContactModel::undamped(const Touches& touches, Vec3 axis) noexcept {
  return push(touches, axis, {}, [](const wire::ContactPlane& plane, Vec3, Vec3, double, double) {
    return ContactGains{.stiffness = static_cast<double>(plane.stiffness_n_per_mm)};
  });
}

void ContactModel::take(const ServerWrench& answer, const Grip& then, const Grip& now,
                        const Twist& velocity) noexcept {
  const Wrench before = damped(touches_at(now), now.axis, velocity) + fading_;
  answer_ = answer;
  then_ = then;
  fading_ = before - damped(touches_at(now), now.axis, velocity);
  const std::uint64_t age_us = answer.arrival_us - std::min(answer.arrival_us, answer.pose_us);
  fade_s_ =
      length(fading_.force_n) > kStepN
          ? kFadeS
          : std::clamp(kFadeAges * kSPerUs * static_cast<double>(age_us), kLeastFadeS, kFadeS);
}

Wrench ContactModel::at(const Grip& now, const Twist& velocity, double dt_s) noexcept {
  fading_ = fading_ * std::exp(-dt_s / fade_s_);
  const Touches touches = touches_at(now);
  computed_ = undamped(touches, now.axis);
  return damped(touches, now.axis, velocity) + fading_;
}

Wrench ContactModel::in_answer() const noexcept { return undamped(touches_at(then_), then_.axis); }

}  // namespace kerf::agent
