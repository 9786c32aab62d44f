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

/// What was removed from a group: middles of the segments, and their lengths (mm).
struct GroupSegments {
  GroupPoints middle;
  Lanes length;
};

/// What part of a removed element the rays of one of three fields count: n_z² in the field's frame,
/// n being the normal of the tool's surface where it is nearest to the element. Over the three
/// fields these parts add up to one; a field counts nothing of a wall that its rays are parallel
/// to, which is just the wall whose place it knows only to a pitch.
class SurfaceWeight {
 public:
  explicit SurfaceWeight(const Tool& tool);

  /// The part of each of a group's points, for a tool whose unit axis is `axis` in the field's
  /// frame.
  void evaluate(const GroupPoints& points, Vec3 axis, Lanes& weight) const;

  /// Multiplies the length of each segment by the part of it that counts; one that is long for a
  /// tool of this radius is asked at two points.
  void weigh(std::span<GroupSegments> groups, Vec3 axis, double radius_mm) const;

  /// Both, as parts of functions that are compiled for one instruction set.
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
