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
  enum class Side { kLine, kArc };
  /// A convex piece in the half-plane (ρ, h): distance from the axis, height above the tip. The
  /// discs at its ends bound the tool only beyond the radii to which other pieces cover them.
  struct Piece {
    Side side;
    double z0, z1;                          ///< heights of its ends
    double r0, slope, normal_r;             /// of a line: ρ at z0, dρ/dh, and 1/√(1 + slope²)
    double center_r, center_z, radius;      ///< of an arc
    double covered_below2, covered_above2;  ///< squares of those radii

    double radius_at(double h) const;
  };
  struct Meridian;
  static Piece piece_of(const ToolPiece& piece);
  static void nearest_of(const Piece& piece, const Meridian& at, Lanes& nearest, Lanes& normal_z);

  std::vector<Piece> pieces_;
};

}  // namespace kerf
