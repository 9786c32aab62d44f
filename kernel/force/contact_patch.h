// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kernel/force/contact_plane.h"
#include "kernel/math/vec3.h"
#include "kernel/tool/convex_part.h"

namespace kerf {

/// Sums over the points of a contact by their pressure: its center and its extent.
class PatchSum {
 public:
  /// Adds a point with a weight, its pressure times its area. Only ratios of weights matter.
  void add(Vec3 point_mm, double weight);

  double weight() const { return weight_; }
  /// Returns the weighted mean of the points. The total weight must be positive.
  Vec3 center_mm() const;
  /// Sets the point of a contact plane to the center, and its half axes to twice the standard
  /// deviation of the points along the two principal directions of the plane. Leaves a plane
  /// unchanged without a weight.
  void place(ContactPlane& plane) const;

 private:
  double weight_ = 0;
  /// The first point, because second moments about the frame's origin lose digits.
  Vec3 origin_mm_;
  Vec3 moment_;
  Vec3 squares_, products_;  ///< xx, yy, zz; yz, zx, xy
};

/// Returns whether a part of a tool ends in a ball at this height of its axis. It touches with a
/// point at any depth there, because it does not resist turning about the ball's center.
bool touches_with_a_point(const ConvexPart& part, double z_mm);

/// Replaces planes with half axes by points on the rim of that ellipse: three, or two if one half
/// axis is short. A plane with two short half axes remains. Each point has the depth of its plane
/// and an equal part of its stiffness, so the wrench remains the same, and a spring at each point
/// resists turning as the area does. The deepest planes are replaced first, as long as the total is
/// at most `most`. The order remains.
std::vector<ContactPlane> spread(std::span<const ContactPlane> planes, std::size_t most);

}  // namespace kerf
