// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/contact_plane.h"

namespace kerf {

Wrench wrench_of(std::span<const ContactPlane> planes, const ToolPose& pose, double pivot_mm) {
  Wrench sum;
  const Vec3 pivot = pose.tip_mm + pose.axis * pivot_mm;
  for (const ContactPlane& plane : planes) {
    if (!(plane.depth_mm > 0)) continue;
    const Vec3 f = plane.normal * (plane.depth_mm * plane.stiffness_n_per_mm);
    sum = sum + Wrench{f, cross(plane.point_mm - pivot, f)};
  }
  sum.torque_nmm = sum.torque_nmm - pose.axis * dot(sum.torque_nmm, pose.axis);
  return sum;
}

}  // namespace kerf
