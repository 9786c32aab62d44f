// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/vec3.h"
#include "kernel/tool/convex_part.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// A stretch of a column, mm in the field's frame; empty unless lo < hi.
struct Heights {
  double lo, hi;
};
/// The point of a stretch that is deepest in a part.
struct Deepest {
  double outside = 0;  ///< signed distance from the part, mm; negative inside
  double z = 0;
  bool pruned = true;  ///< no relevant depth is possible, and the search was stopped
};

/// A part of a tool at a pose in the frame of a field, for queries along columns.
class PlacedPart {
 public:
  PlacedPart(const ConvexPart& part, const ToolPose& pose);

  Vec3 lo, hi;  ///< its bounding box

  /// Returns the signed distance of a point from the part's side and bottom, mm, and its gradient
  /// in `outward` if that is not null. On the axis, the gradient is the mean of those around it.
  /// The distance is exact inside and near the part, and convex, with a gradient of at most 1. The
  /// top is excluded, because a part adjoins the one above and a point cannot leave through it. So
  /// is the bottom if the part below covers it.
  double at(Vec3 point, Vec3* outward = nullptr) const;

  /// Returns the direction out of the part at a point, not of unit length. On the axis of a
  /// cylinder, where the gradient vanishes, it is one of the equally short directions across it.
  Vec3 exit_direction(Vec3 point) const;

  /// Returns the heights of a column that are not above the part's top.
  Heights below_top(double x, double y, Heights z) const;

  /// Finds the deepest point of a column inside the part. Between two heights a convex function is
  /// above its tangents there. The next height to evaluate is where the tangents meet. The value
  /// there is a lower bound, which shows when no point of the column, or of columns up to
  /// `around_mm` away in x and y, can be more than `threshold_mm` inside, and when the deepest
  /// point has been found.
  Deepest least(double x, double y, Heights z, double threshold_mm, double around_mm = 0) const;

 private:
  struct Tangent {
    double z, mm;
    Vec3 gradient;
    double slope() const { return gradient.z; }
  };
  Tangent tangent(double x, double y, double z) const;

  const ConvexPart& part_;
  ToolPose pose_;
  Extent reach_;
};

}  // namespace kerf
