// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kernel/force/tool_side.h"
#include "kernel/math/lanes.h"
#include "kernel/math/vec3.h"
#include "kernel/tool/tool.h"

namespace kerf {

/// Points of one group of columns, relative to the tool's tip (mm).
struct GroupPoints {
  Lanes x;
  double y;
  Lanes z;
};

/// The segments removed from a group: their centers and lengths (mm).
struct GroupSegments {
  GroupPoints middle;
  Lanes length;
};

/// The weight of a removed element in one of three fields: n_z² in the field's frame, where n is
/// the normal of the tool's surface nearest to the element. The weights of the three fields add up
/// to 1. A wall parallel to a field's rays, which the field locates only to a pitch, has the weight
/// 0.
class SurfaceWeight {
 public:
  explicit SurfaceWeight(const Tool& tool);

  /// Computes the weight of each of a group's points, for a tool whose unit axis is `axis` in the
  /// field's frame.
  void evaluate(const GroupPoints& points, Vec3 axis, Lanes& weight) const;

  /// Multiplies the length of each segment by its weight. If the segment is long relative to the
  /// tool's radius `radius_mm`, the weight is evaluated at two points.
  void weigh(std::span<GroupSegments> groups, Vec3 axis, double radius_mm) const;

  /// Inline versions of both, for functions that are compiled per instruction set.
  Lanes evaluate_in_lanes(const GroupPoints& points, Vec3 axis) const;
  void weigh_in_lanes(std::span<GroupSegments> groups, Vec3 axis, double radius_mm) const;

 private:
  struct Meridian;
  static void nearest_of(const CoveredPiece& piece, const Meridian& at, Lanes& nearest,
                         Lanes& normal_z);

  std::vector<CoveredPiece> pieces_;
};

}  // namespace kerf
