// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernel/tool/tool.h"
#include "kernel/tool/tool_pose.h"

namespace kerf::test {

/// The solid that a tool sweeps along the true motion (the definition in kernel/README.md), queried
/// point by point. It has no sampling density: the search over time is bounded by the speed of a
/// point in the tool's frame, so a tool of 0.01 mm on a path of 10 m is found as reliably as one of
/// 500 mm that moves by a nanometer. Shares no code with the kernel's sweeps.
class TrueSweep {
 public:
  TrueSweep(const Tool& tool, const ToolPose& from, const ToolPose& to);

  /// Returns the distance (mm) of the point from the swept solid; negative: its depth inside one
  /// piece of the tool. For distances above `interest_mm` any value above it may be returned.
  double outside(Vec3 point, double interest_mm) const;
  /// Returns whether all points within `margin_mm` of the point (in the tool's half-plane) are
  /// inside the tool at some time, despite seams between its pieces.
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
