// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/guides/guide_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "haptic_agent/device/units.h"
#include "haptic_agent/guides/surface_distance.h"
#include "server/formats/guide_reader.h"

namespace kerf::agent {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;
/// A guide counts as used in ticks with more force (N) or torque (N·mm) than this.
constexpr double kUsed = 0.01;
/// N/mm; bounds the length over which a stroke's force reverses.
constexpr double kLeastStiffness = 0.05;

double force_and_torque(const Wrench& wrench) noexcept {
  return std::max(length(wrench.force_n), length(wrench.torque_nmm));
}

/// Stiffest torsional spring and its damper for the least inertia, as stable_gains has them for
/// forces: N·mm/rad, N·mm·s/rad.
ContactGains stable_turn_gains(const ServoSettings& settings, double stiffness) noexcept {
  constexpr double kStiffnessShare = 0.8, kDampingShare = 0.5;
  const double inertia = settings.passivity.inertia_kg_m2 * kNmmPerNm;
  const double damping =
      std::min(settings.passivity.max_turn_damping,
               kDampingShare * inertia / settings.model.contact.velocity_delay_s);
  const double stable = kStiffnessShare * damping / settings.model.contact.force_delay_s;
  return {.stiffness = std::min(stiffness, stable), .damping = damping};
}

}  // namespace

GuideModel::GuideModel(const std::vector<Guide>& guides, const ServoSettings& settings,
                       double strength)
    : settings_(settings), strength_(strength) {
  for (const Guide& guide : guides) {
    Compiled compiled{.guide = guide, .tree = {}, .last_mm = {}};
    if (auto* path = std::get_if<PathGuide>(&compiled.guide.shape)) {
      compiled.tree.emplace(path->paths);
      path->paths.clear();
    }
    guides_.push_back(std::move(compiled));
    uses_.push_back({.kind = kind_of(guide)});
  }
}

Wrench GuideModel::at(const PastGrip& now) noexcept {
  const Vec3 arm = now.grip.axis * -settings_.pivot_mm;
  const Tip tip{now, now.grip.pivot_mm + arm, arm, now.velocity.at(arm)};
  Wrench sum;
  if (!(strength_ > 0)) return sum;
  for (std::size_t i = 0; i < guides_.size(); ++i) {
    Wrench one = wrench(guides_[i], tip);
    // Five degrees of freedom: no torque about the tool's own axis.
    one.torque_nmm = one.torque_nmm - now.grip.axis * dot(one.torque_nmm, now.grip.axis);
    if (force_and_torque(one) > kUsed) ++uses_[i].ticks;
    uses_[i].max_force_n = std::max(uses_[i].max_force_n, length(one.force_n));
    sum = sum + one;
  }
  return sum;
}

Wrench GuideModel::wrench(Compiled& compiled, const Tip& tip) const noexcept {
  const Guide& guide = compiled.guide;
  if (const auto* path = std::get_if<PathGuide>(&guide.shape))
    return along_path(compiled, *path, tip);
  if (const auto* plane = std::get_if<PlaneGuide>(&guide.shape))
    return push(guide, plane->normal, dot(plane->normal, plane->point_mm - tip.tip_mm), tip);
  if (const auto* depth = std::get_if<DepthGuide>(&guide.shape))
    return push(guide, {0, 0, 1}, depth->lowest_z_mm - tip.tip_mm.z, tip);
  if (const auto* region = std::get_if<RegionGuide>(&guide.shape)) {
    const SurfaceDistance face = box_distance(region->min_mm, region->max_mm, tip.tip_mm);
    return push(guide, face.normal, -face.distance_mm, tip);
  }
  return snap(guide, std::get<SnapGuide>(guide.shape), tip);
}

/// Spring and damper along a direction: no stiffer than the device, and shared by all guides.
ContactGains GuideModel::gains(const Guide& guide, Vec3 normal, const Tip& tip) const noexcept {
  return stable_gains(settings_.model.contact, strength_ * guide.stiffness_n_per_mm, tip.arm_mm,
                      normal, static_cast<std::uint32_t>(guides_.size()));
}

/// Returns the force of a wall that the tip has entered by `depth_mm` against its normal.
Wrench GuideModel::push(const Guide& guide, Vec3 normal, double depth_mm,
                        const Tip& tip) const noexcept {
  if (!(depth_mm > 0)) return {};
  const ContactGains g = gains(guide, normal, tip);
  const double newtons =
      std::clamp(g.stiffness * depth_mm - g.damping * dot(normal, tip.velocity_mm_per_s), 0.0,
                 strength_ * guide.max_force_n);
  const Vec3 force = normal * newtons;
  return {force, cross(tip.arm_mm, force)};
}

Wrench GuideModel::snap(const Guide& guide, const SnapGuide& shape, const Tip& tip) const noexcept {
  const SnapSurface& s = *shape.surface;
  const SurfaceDistance face = s.cylinder ? cylinder_distance(s.min_mm, s.max_mm, tip.tip_mm)
                                          : box_distance(s.min_mm, s.max_mm, tip.tip_mm);
  const double apart = std::abs(face.distance_mm);
  const double range = shape.range_mm;
  if (apart >= range) return {};
  // The spring is strongest in the middle of the range and ends without a step.
  const double stretched = std::copysign(std::min(apart, range - apart), face.distance_mm);
  const double stiffness =
      strength_ * std::min(guide.stiffness_n_per_mm, guide.max_force_n / (range / 2));
  const ContactGains g = stable_gains(settings_.model.contact, stiffness, tip.arm_mm, face.normal,
                                      static_cast<std::uint32_t>(guides_.size()));
  const double damping = g.damping * (1 - apart / range);
  const double most = strength_ * guide.max_force_n;
  const double newtons = std::clamp(
      -g.stiffness * stretched - damping * dot(face.normal, tip.velocity_mm_per_s), -most, most);
  const Vec3 force = face.normal * newtons;
  return {force, cross(tip.arm_mm, force)};
}

/// Returns the torque that turns the tool's axis back to within an angle of the path's.
Vec3 GuideModel::turn(const PathGuide& path, Vec3 axis, const Tip& tip) const noexcept {
  const Vec3 normal = cross(tip.now.grip.axis, axis);
  const double sine = length(normal);
  const double excess =
      std::atan2(sine, dot(tip.now.grip.axis, axis)) - path.axis_within_deg * kRadPerDeg;
  if (!(excess > 0) || !(sine > 0)) return {};
  const Vec3 about = normal * (1 / sine);
  const ContactGains g = stable_turn_gains(settings_, strength_ * path.turn_stiffness_nmm_per_rad);
  const double torque = g.stiffness * excess - g.damping * dot(about, tip.now.velocity.angular);
  return about * std::clamp(torque, 0.0, strength_ * path.max_torque_nmm);
}

Wrench GuideModel::along_path(Compiled& compiled, const PathGuide& path,
                              const Tip& tip) const noexcept {
  const GuidePoint near = compiled.tree->nearest(tip.tip_mm);
  const double beyond = near.distance_mm - path.within_mm;
  Wrench sum;
  if (beyond > 0) {
    const Vec3 inward = (near.tip_mm - tip.tip_mm) * (1 / near.distance_mm);
    sum = push(compiled.guide, inward, beyond, tip);
  }
  sum.torque_nmm = sum.torque_nmm + turn(path, near.axis, tip);
  if (path.stroke) sum = sum + taught(compiled, path, near, tip);
  return sum;
}

/// Returns the teacher's wrench: in full while the tool moves forward along the stroke, not at all
/// backward, and less beyond the distance that the guide allows.
Wrench GuideModel::taught(Compiled& compiled, const PathGuide& path, const GuidePoint& near,
                          const Tip& tip) const noexcept {
  const Guide& guide = compiled.guide;
  const ContactGains g = gains(guide, near.tangent, tip);
  // A force F that reverses over a shorter length than F/k would be a stiffer spring than k.
  const double heading_mm = guide.max_force_n / std::max(g.stiffness, kLeastStiffness);
  const Vec3 moved = compiled.last_mm ? tip.tip_mm - *compiled.last_mm : Vec3{};
  compiled.heading = (compiled.heading * heading_mm + moved) * (1 / (heading_mm + length(moved)));
  compiled.last_mm = tip.tip_mm;
  const double forward = std::max(0.0, dot(compiled.heading, near.tangent));
  const double fade = std::clamp(2 - near.distance_mm / path.within_mm, 0.0, 1.0);
  const Wrench felt = near.felt * path.felt_share;
  const double share = share_within({guide.max_force_n, path.max_torque_nmm}, felt);
  const Vec3 damper = near.tangent * (-g.damping * dot(near.tangent, tip.velocity_mm_per_s));
  const double part = strength_ * forward * fade;
  return (felt * share + Wrench{damper, cross(tip.arm_mm, damper)}) * part;
}

std::expected<std::vector<Guide>, std::string> guides_of(std::string_view welcome) {
  auto guides = parse_guides(welcome);
  if (!guides) return std::unexpected("the session's guides are not valid: " + guides.error());
  return guides;
}

std::string guide_notice(const std::vector<Guide>& guides, double strength) {
  if (guides.empty()) return {};
  std::ostringstream out;
  out << "the session has guides:";
  const char* separator = " ";
  for (const Guide& guide : guides) {
    out << separator << kind_of(guide);
    if (const auto* path = std::get_if<PathGuide>(&guide.shape))
      out << " within " << path->within_mm << " mm";
    separator = ", ";
  }
  if (strength > 0) {
    out << "; strength " << strength << ", --guides 0 switches them off";
  } else {
    out << "; switched off by --guides 0";
  }
  return out.str();
}

}  // namespace kerf::agent
