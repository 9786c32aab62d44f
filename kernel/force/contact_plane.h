// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kernel/math/wrench.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// A plane that approximates the surface of an obstacle or of the stock near a contact. A device
/// renders the contact from it while the tool moves a little (the intermediate representation of Y.
/// Adachi et al., 1995).
struct ContactPlane {
  /// Point of attack: the center of pressure, that is, the mean over the area of contact, weighted
  /// by the square of the depth. For a gap, the tool's nearest point.
  Vec3 point_mm;
  Vec3 normal;  ///< unit, out of the surface
  /// Penetration of the deepest point, which may differ from `point_mm`. Negative: width of the
  /// gap.
  double depth_mm = 0;
  double stiffness_n_per_mm = 0;
  double radius_mm = 0;  ///< radius around `point_mm` in which the plane is valid
  bool stock = false;    ///< of the stock, not of an obstacle
  /// Half axes of the ellipse about `point_mm`, normal to `normal`, at whose rim springs resist
  /// turning as the area of the contact does. Zero for a point (contact_patch.h).
  Vec3 half_a_mm{}, half_b_mm{};
  /// A further point of the contact that the preceding plane begins (spread).
  bool continues = false;
};

/// Distance, in mm, at which the plane of an obstacle is reported before contact. If it grows,
/// planes approximate curved obstacles less well.
inline constexpr double kContactReachMm = 5;

/// Computes F_collision and τ_collision (paper Eqs. 25, 26) of contact planes: stiffness x depth
/// along each normal whose depth is positive. In N, and N·mm about the pivot without the component
/// about the tool's axis.
Wrench wrench_of(std::span<const ContactPlane> planes, const ToolPose& pose, double pivot_mm);

}  // namespace kerf
