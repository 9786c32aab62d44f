// SPDX-License-Identifier: Apache-2.0
// Fig. 16 and section 3: force and torque along a curved path.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/kernel/extremes/carving.h"
#include "tests/paper/check.h"
#include "tests/paper/examples.h"

namespace kerf::paper {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

/// How a path of Fig. 16 is cut.
struct Cut {
  std::string tool;
  ToolShape shape = BallShape{6, 30};
  ForceLaw law = ForceLaw::kDexelRemovalRate;
  Rays rays = Rays::kDexel;
  double lean = 0;   ///< of the axis, rad
  double swing = 0;  ///< of the lean along the path, rad
};

/// Every tool shape, both laws, three fields, a tool that leans and one that swings. The last two
/// turn the force out of the plane of the path.
std::vector<Cut> cuts() {
  std::vector<Cut> all;
  for (const auto& [name, shape] : std::vector<std::pair<const char*, ToolShape>>{
           {"ball", BallShape{6, 30}},
           {"flat", FlatShape{6, 30}},
           {"taper", TaperShape{3, 12, 30}},
           {"cone end", ConeEndShape{6, 90, 30}},
           {"bull nose", BullNoseShape{6, 1.5, 30}},
           {"dovetail",
            ProfileShape{{ProfilePoint{3, 0}, ProfilePoint{2, 4}, ProfilePoint{2, 30}}}}}) {
    all.push_back({.tool = name, .shape = shape});
  }
  all.push_back({.tool = "ball, u A", .law = ForceLaw::kSpecificEnergy});
  all.push_back({.tool = "ball, 3 fields", .rays = Rays::kTriDexel});
  all.push_back({.tool = "leaning ball", .lean = 0.35});
  all.push_back({.tool = "swinging ball", .lean = 0.1, .swing = 0.25});
  return all;
}

std::vector<Step> steps_of(const Cut& cut) {
  Example one = curve();
  one.shape = cut.shape;
  one.settings.rays = cut.rays;
  one.settings.keep_normals = false;
  if (cut.rays == Rays::kTriDexel) one.settings.pitch_mm = 0.2;
  one.settings.force.law = cut.law;
  for (std::size_t n = 0; n < one.path.size(); ++n) {
    const double s = double(n) / double(one.path.size());
    const double lean = cut.lean + cut.swing * std::sin(2 * std::numbers::pi * s);
    one.path[n].axis = {std::sin(lean) * 0.6, std::sin(lean) * 0.8, std::cos(lean)};
  }
  std::vector<Step> steps = carve(one).steps;
  steps.erase(steps.begin(), steps.begin() + 8);  // the tool appears in the stock and settles
  return steps;
}

Vec3 pivot_of(const Step& step) {
  const ForceSettings force = curve().settings.force;
  return (step.from.tip_mm + step.to.tip_mm) * 0.5 + step.to.axis * force.pivot_mm;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

double degrees_between(Vec3 a, Vec3 b) {
  return kDegrees * std::atan2(length(cross(a, b)), dot(a, b));
}

Finding force_along_the_tangent() {
  double worst = 0, turned = 0, of_tip = 0;
  for (const Cut& cut : cuts()) {
    std::vector<double> angles, tip_angles;
    for (const Step& step : steps_of(cut)) {
      // The path of the point that is cut, which is the tip's path unless the tool turns.
      const Vec3 travel = step.to.tip_mm - step.from.tip_mm;
      const Vec3 arm = step.result.cutting.center_mm - (step.from.tip_mm + step.to.tip_mm) * 0.5;
      const Vec3 tangent = travel + cross(cross(step.from.axis, step.to.axis), arm);
      angles.push_back(degrees_between(-step.result.wrench.force_n, tangent));
      tip_angles.push_back(degrees_between(-step.result.wrench.force_n, travel));
    }
    worst = std::max(worst, median(angles));
    of_tip = std::max(of_tip, median(tip_angles));
    turned = std::max(turned, *std::ranges::max_element(angles));
  }
  return {
      worst <= 1,
      text("%zu cuts: median angle of −F and the tangent of the path of the cut at most %.2f° in "
           "the worst, %.1f° in any step; of the path of the tip, %.2f° (a tool that swings)",
           cuts().size(), worst, turned, of_tip)};
}

/// Returns the least share by which torques deviate from k |F|, over all factors k.
double departure_from_proportion(const std::vector<Step>& steps) {
  double least = HUGE_VAL, most = 0;
  for (const Step& step : steps) {
    const double factor =
        length(step.result.wrench.torque_nmm) / length(step.result.wrench.force_n);
    least = std::min(least, factor);
    most = std::max(most, factor);
  }
  return (most - least) / (most + least);
}

Finding torque_proportional_to_force() {
  double worst = 0, tilted = 0;
  for (const Cut& cut : cuts()) {
    double& most = cut.lean > 0 ? tilted : worst;
    most = std::max(most, departure_from_proportion(steps_of(cut)));
  }
  return {worst <= 0.02,
          text("upright tools: the length of τ departs from k times that of F by at most %.2f %% "
               "in any step; tools that "
               "lean, up to %.1f %%: the arm across F is the one that the lean leaves",
               100 * worst, 100 * tilted)};
}

Finding right_hand_rule() {
  double worst = 0, least = 1;
  for (const Cut& cut : cuts()) {
    std::vector<double> angles;
    for (const Step& step : steps_of(cut)) {
      Vec3 turn = cross(step.result.cutting.center_mm - pivot_of(step), step.result.wrench.force_n);
      // A device of 5 DOF cannot display torque about the axis.
      turn = turn - step.to.axis * dot(turn, step.to.axis);
      const Vec3 torque = normalized(step.result.wrench.torque_nmm);
      const double cosine = dot(normalized(turn), torque);
      angles.push_back(degrees_between(turn, torque));
      least = std::min(least, cosine);
    }
    worst = std::max(worst, median(angles));
  }
  return {worst <= 1 && least > 0.99,
          text("τ and (P − P_pivot) × F: median angle at most %.2f° in the worst cut, cosine at "
               "least %.4f in any step",
               worst, least)};
}

Finding force_across_torque() {
  double level = 0, any = 0;
  for (const Cut& cut : cuts()) {
    for (const Step& step : steps_of(cut)) {
      const Wrench& w = step.result.wrench;
      const double cosine =
          std::abs(dot(w.force_n, w.torque_nmm)) / (length(w.force_n) * length(w.torque_nmm));
      double& most = cut.lean > 0 ? any : level;
      most = std::max(most, cosine);
    }
  }
  return {
      level <= 0.001 && any <= 0.005,
      text("cosine of F and τ at most %.4f of upright tools, %.4f of tools that lean, whose torque "
           "about their own axis is left out",
           level, any)};
}

/// Eq. 18: force over removed volume per second, in a straight slot of changing depth.
Finding force_proportional_to_removal() {
  double worst = 0;
  constexpr double kRate = 0.002, kSpeed = 20;
  for (const Cut& cut : cuts()) {
    if (cut.law != ForceLaw::kDexelRemovalRate || cut.lean > 0) continue;
    Example one = curve();
    one.shape = cut.shape;
    one.settings.rays = cut.rays;
    one.settings.keep_normals = false;
    one.settings.force.drr_n_s_per_mm3 = kRate;
    one.speed_mm_per_s = kSpeed;
    one.path.clear();
    for (int n = 0; n <= 24; ++n) one.path.push_back({{5 + 2.0 * n, 20, -1 - 0.08 * n}});
    const std::vector<Step> steps = carve(one).steps;
    double force = 0, volume = 0, seconds = 0;
    for (std::size_t n = 2; n < steps.size(); ++n) {
      force += length(steps[n].result.wrench.force_n);
      volume += steps[n].result.removed_mm3;
      seconds += length(steps[n].to.tip_mm - steps[n].from.tip_mm) / kSpeed;
    }
    const double mean = kRate * volume / seconds;
    worst = std::max(worst, std::abs(force / double(steps.size() - 2) / mean - 1));
  }
  return {worst <= 0.02,
          text("F = K dV/dt within %.2f %% over slots that get three times as deep", 100 * worst)};
}

}  // namespace

std::vector<Check> force_checks() {
  return {{"ForceIsAgainstTheTangent", force_along_the_tangent},
          {"TorqueIsProportionalToForce", torque_proportional_to_force},
          {"TorqueFollowsTheRightHandRule", right_hand_rule},
          {"ForceIsAcrossTorque", force_across_torque},
          {"ForceIsProportionalToRemovalRate", force_proportional_to_removal}};
}

}  // namespace kerf::paper
