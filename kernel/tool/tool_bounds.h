// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "kernel/tool/tool.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// A box with sides along the axes, mm.
struct Bounds {
  Vec3 lo_mm, hi_mm;
};

/// The smallest box around two.
inline Bounds joined(const Bounds& a, const Bounds& b) {
  return {{std::min(a.lo_mm.x, b.lo_mm.x), std::min(a.lo_mm.y, b.lo_mm.y),
           std::min(a.lo_mm.z, b.lo_mm.z)},
          {std::max(a.hi_mm.x, b.hi_mm.x), std::max(a.hi_mm.y, b.hi_mm.y),
           std::max(a.hi_mm.z, b.hi_mm.z)}};
}

/// A box larger by `mm` on every side.
inline Bounds grown(const Bounds& box, double mm) {
  return {box.lo_mm - Vec3{mm, mm, mm}, box.hi_mm + Vec3{mm, mm, mm}};
}

/// A box around the whole tool, shank and holder included, at a pose with a unit axis: that of the
/// cylinder around it, and as small as it can be.
inline Bounds tool_bounds(const Tool& tool, const ToolPose& pose) {
  const auto across = [&](double component) {
    return tool.whole_radius_mm * std::sqrt(std::max(0.0, 1 - component * component));
  };
  const Vec3 reach{across(pose.axis.x), across(pose.axis.y), across(pose.axis.z)};
  const Vec3 top_mm = pose.tip_mm + pose.axis * tool.whole_length_mm;
  const Bounds spine = joined({pose.tip_mm, pose.tip_mm}, {top_mm, top_mm});
  return {spine.lo_mm - reach, spine.hi_mm + reach};
}

}  // namespace kerf
