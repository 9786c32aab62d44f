// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "kernel/sculpture.h"

namespace kerf::test {

/// A tool that starts upright, deep in stock, and swivels about a point of its axis.
struct Swivel {
  Tool tool;
  Rays rays = Rays::kDexel;
  double pitch_mm = 0.1;
  double depth_mm = 10;
  double above_tip_mm = 5;   ///< height of the point about which it swivels
  double heading_rad = 0.3;  ///< of the swivel in the plane of the block's top
};

/// Returns the work of the wrench against a whole engagement over u V, which is 1 for
/// `specific_energy`. The engagement begins free, since the imprint gives no force, and ends free:
/// after the tool has swivelled by 14 degrees, another tool clears the path ahead, and the tool
/// continues until nothing is pending.
inline double work_over_energy(const Swivel& swivel) {
  constexpr double kTickRad = 0.005, kSpecific = 0.5, kPivotMm = 60;
  constexpr int kCut = 50, kFree = 50;
  Sculpture sculpture =
      *Sculpture::create({.stock = BoxStock{{-20, -20, -25}, {20, 20, 0}},
                          .rays = swivel.rays,
                          .pitch_mm = swivel.pitch_mm,
                          .tolerance_mm = 0.001,
                          .force = {ForceLaw::kSpecificEnergy, kSpecific, 0.01, kPivotMm}});
  for (const ToolId tool : {1, 2}) sculpture.apply(DefineTool{tool, swivel.tool}).value();
  const Vec3 center{0.0371, 0.0213, swivel.above_tip_mm - swivel.depth_mm};
  const Vec3 heading{std::cos(swivel.heading_rad), std::sin(swivel.heading_rad), 0};
  const auto pose = [&](int tick) {
    const double angle = tick * kTickRad;
    const Vec3 axis = heading * std::sin(angle) + Vec3{0, 0, std::cos(angle)};
    return ToolPose{center - axis * swivel.above_tip_mm, axis};
  };
  double work_mj = 0, cut_mm3 = 0;
  for (int tick = 0; tick < kCut + kFree; ++tick) {
    if (tick == kCut) {
      for (int t = kCut; t < kCut + kFree; ++t)
        sculpture.apply(MoveTool{2, pose(t), pose(t + 1), 0.001, false}).value();
    }
    const ToolPose from = pose(tick), to = pose(tick + 1);
    const MotionResult r = sculpture.apply(MoveTool{1, from, to, 0.001}).value();
    const Vec3 turned = normalized(cross(from.axis, to.axis)) * kTickRad;
    const Vec3 moved = to.tip_mm + to.axis * kPivotMm - from.tip_mm - from.axis * kPivotMm;
    work_mj += work(r.wrench, {moved, turned});
    cut_mm3 += r.removed_mm3 - r.imprint_mm3;
  }
  return -work_mj / (kSpecific * cut_mm3);
}

}  // namespace kerf::test
