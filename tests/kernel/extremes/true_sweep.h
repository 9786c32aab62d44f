// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernel/tool/tool.h"
#include "kernel/tool/tool_pose.h"

namespace kerf::test {

/// The solid that a tool sweeps along the true motion (design section 3), asked point by point. No
/// sampling density: the search over time is bounded by how fast a point can move through the
/// tool's frame, so a tool of 0.01 mm on a way of 10 m is found as surely as one of 500 mm that
/// moves by a nanometre. Shares no code with the kernel's sweeps.
class TrueSweep {
 public:
  TrueSweep(const Tool& tool, const ToolPose& from, const ToolPose& to);

  /// How far (mm) the point lies outside the swept solid; negative: how deep inside one piece of
  /// the tool. Values above `interest_mm` are not looked into: any value above it may be returned.
  double outside(Vec3 point, double interest_mm) const;
  /// Whether everything within `margin_mm` of the point (in the tool's half-plane) lies inside the
  /// tool at some time, seams between its pieces notwithstanding.
  bool well_inside(Vec3 point, double margin_mm) const;
  ToolPose at(double share) const;

 private:
  template <class F>
  double least(Vec3 point, double interest_mm, F value) const;

  Tool tool_;
  ToolPose from_, to_;
  double angle_ = 0;
};

}  // namespace kerf::test
