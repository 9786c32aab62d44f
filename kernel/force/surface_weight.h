// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kernel/math/lanes.h"
#include "kernel/math/vec3.h"
#include "kernel/tool/tool.h"

namespace kerf {

/// Points of one group of columns, from the tool's tip (mm).
struct GroupPoints {
  Lanes x;
  double y;
  Lanes z;
};

/// Segments removed from a group: their middles and lengths (mm).
struct GroupSegments {
  GroupPoints middle;
  Lanes length;
};

/// Weight of a removed element in one of three fields: n_z² in the field's frame, where n is the
/// normal of the tool's surface nearest to the element. Over the three fields the weights add up to
/// one. A field gives no weight to a wall parallel to its rays, whose position it resolves only to
/// a pitch.
class SurfaceWeight {
 public:
  explicit SurfaceWeight(const Tool& tool);

  /// Computes the weight of each of a group's points, for a tool whose unit axis is `axis` in the
  /// field's frame.
  void evaluate(const GroupPoints& points, Vec3 axis, Lanes& weight) const;

  /// Multiplies the length of each segment by its weight. A segment that is long relative to the
  /// tool's radius is evaluated at two points.
  void weigh(std::span<GroupSegments> groups, Vec3 axis, double radius_mm) const;

  /// Both, inlined into functions that are compiled for one instruction set.
  Lanes evaluate_in_lanes(const GroupPoints& points, Vec3 axis) const;
  void weigh_in_lanes(std::span<GroupSegments> groups, Vec3 axis, double radius_mm) const;

 private:
  /// A piece, and the radii up to which other pieces cover the discs at its ends: beyond them these
  /// discs bound the tool.
  struct Piece {
    PieceProfile profile;
    double covered_below2, covered_above2;  ///< squares of those radii
  };
  struct Meridian;
  static void nearest_of(const Piece& piece, const Meridian& at, Lanes& nearest, Lanes& normal_z);

  std::vector<Piece> pieces_;
};

}  // namespace kerf
