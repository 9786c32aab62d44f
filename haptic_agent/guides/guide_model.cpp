// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/guides/guide_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "haptic_agent/device/units.h"
#include "haptic_agent/guides/surface_distance.h"
#include "haptic_agent/servo/grip.h"
#include "server/formats/guide_reader.h"

namespace kerf::agent {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;
/// A guide counts as used in ticks with a force (N) or torque (N·mm) above this.
constexpr double kUsed = 0.01;
/// Bounds the length over which a stroke's force reverses, N/mm.
constexpr double kLeastStiffness = 0.05;
/// Bounds the turn of a path's axis per distance, N·mm.
constexpr double kLeastTorqueNmm = 1e-3;
/// Far above the rounding of an axis.
constexpr double kSameAxisRad = 1e-9;

double force_and_torque(const Wrench& wrench) noexcept {
  return std::max(length(wrench.force_n), length(wrench.torque_nmm));
}

/// The stiffest angular spring and its damper, N mm/rad and N mm s/rad, of which this spring has a
/// share. `push`: force and torque that the spring exerts per N mm. The more they move, the less
/// inertia the spring sees.
ContactGains stable_turn_gains(const ServoSettings& settings, double stiffness, const Wrench& push,
                               double share) noexcept {
  const ContactLimits& contact = settings.model.contact;
  const double inertia =
      1 / (dot(push.force_n, push.force_n) * kMmPerM / settings.passivity.mass_kg +
           dot(push.torque_nmm, push.torque_nmm) / (settings.passivity.inertia_kg_m2 * kNmmPerNm));
  const double damping =
      std::min(settings.passivity.max_turn_damping, best_damping(contact, inertia));
  const double stable = share * stable_stiffness(contact, inertia, damping);
  return {.stiffness = std::min(stiffness, stable), .damping = share * damping};
}

}  // namespace

GuideModel::GuideModel(const std::vector<Guide>& guides, const ServoSettings& settings,
                       double strength)
    : settings_(settings), session_pivot_mm_(settings.pivot_mm), strength_(strength) {
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
    // Five degrees of freedom: remove the torque about the tool's own axis.
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

/// Spring and damper along a direction: no stiffer than the device renders, and shared by all
/// guides.
ContactGains GuideModel::gains(const Guide& guide, Vec3 normal, const Tip& tip) const noexcept {
  return stable_gains(settings_.model.contact, strength_ * guide.stiffness_n_per_mm, tip.arm_mm,
                      normal, share());
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
  const ContactGains g =
      stable_gains(settings_.model.contact, stiffness, tip.arm_mm, face.normal, share());
  const double damping = g.damping * (1 - apart / range);
  const double most = strength_ * guide.max_force_n;
  const double newtons = std::clamp(
      -g.stiffness * stretched - damping * dot(face.normal, tip.velocity_mm_per_s), -most, most);
  const Vec3 force = face.normal * newtons;
  return {force, cross(tip.arm_mm, force)};
}

/// Turns the target axis of the tool toward the path's axis, by at most max_force_n /
/// max_torque_nmm per distance that the tip moves. The two differ after the nearest point has
/// jumped to another part of the path. Returns whether they are equal.
bool GuideModel::follow(Compiled& compiled, const PathGuide& path, Vec3 axis,
                        double moved_mm) const noexcept {
  const double most_rad =
      moved_mm * compiled.guide.max_force_n / std::max(path.max_torque_nmm, kLeastTorqueNmm);
  const Vec3 normal = cross(compiled.axis, axis);
  const double sine = length(normal);
  const double apart_rad = std::atan2(sine, dot(compiled.axis, axis));
  if (!compiled.last_mm || apart_rad <= most_rad + kSameAxisRad) {
    compiled.axis = axis;
    return true;
  }
  // Between opposite axes any direction across them gives a shortest turn.
  constexpr double kHalf = 0.5;
  const Vec3 about =
      sine > 0 ? normal * (1 / sine)
               : normalized(cross(axis, std::abs(axis.x) < kHalf ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  compiled.axis = normalized(rotated(compiled.axis, about * most_rad));
  return false;
}

/// Returns the wrench that turns the tool's axis back to within an angle of the path's. Where the
/// path's axis varies by `axis_rate` along it, the wrench includes a force on the tip, because
/// motion along the path changes the angle and thereby the energy of the spring.
Wrench GuideModel::turn(const Compiled& compiled, const PathGuide& path, Vec3 axis_rate,
                        const GuidePoint& near, const Tip& tip) const noexcept {
  const Vec3 axis = tip.now.grip.axis;
  const Vec3 normal = cross(axis, compiled.axis);
  const double sine = length(normal);
  const double excess =
      std::atan2(sine, dot(axis, compiled.axis)) - path.axis_within_deg * kRadPerDeg;
  if (!(excess > 0) || !(sine > 0)) return {};
  const Vec3 about = normal * (1 / sine);
  // The angle decreases by this much per mm along the tangent.
  const double fall = dot(axis, axis_rate) / sine;
  const Vec3 along = near.tangent * fall;
  const Vec3 torque = about + cross(tip.arm_mm, along);
  const Wrench push{along, torque - axis * dot(torque, axis)};
  const ContactGains g =
      stable_turn_gains(settings_, strength_ * path.turn_stiffness_nmm_per_rad, push, share());
  const double most = strength_ * path.max_torque_nmm;
  const double fall_speed =
      dot(about, tip.now.velocity.angular) + dot(along, tip.velocity_mm_per_s);
  const double turned =
      std::clamp(std::min(g.stiffness * excess, most) - g.damping * fall_speed, 0.0, most);
  const double most_force = strength_ * compiled.guide.max_force_n;
  return push * (length(along) * turned > most_force ? most_force / length(along) : turned);
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
  const Vec3 moved_mm = compiled.last_mm ? tip.tip_mm - *compiled.last_mm : Vec3{};
  const bool follows = follow(compiled, path, near.axis, length(moved_mm));
  compiled.last_mm = tip.tip_mm;
  sum = sum + turn(compiled, path, follows ? near.axis_rate : Vec3{}, near, tip);
  if (path.stroke) sum = sum + taught(compiled, path, near, moved_mm, tip);
  return sum;
}

/// Returns the teacher's wrench: in full while the tool moves forward along the stroke, zero
/// backward, and less beyond the distance that the guide allows.
Wrench GuideModel::taught(Compiled& compiled, const PathGuide& path, const GuidePoint& near,
                          Vec3 moved_mm, const Tip& tip) const noexcept {
  const Guide& guide = compiled.guide;
  const ContactGains g = gains(guide, near.tangent, tip);
  // A force F that reverses over a shorter length than F/k would be a stiffer spring than k.
  const double heading_mm = guide.max_force_n / std::max(g.stiffness, kLeastStiffness);
  compiled.heading =
      (compiled.heading * heading_mm + moved_mm) * (1 / (heading_mm + length(moved_mm)));
  const double forward = std::max(0.0, dot(compiled.heading, near.tangent));
  const double fade = std::clamp(2 - near.distance_mm / path.within_mm, 0.0, 1.0);
  Wrench felt = near.felt * path.felt_share;
  const Vec3 farther_mm = near.axis * (session_pivot_mm_ - settings_.pivot_mm);
  felt.torque_nmm = felt.torque_nmm + cross(farther_mm, felt.force_n);
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
