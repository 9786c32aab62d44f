// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "kernel/math/vec3.h"

namespace kerf {

/// An end of an element as it is seen in the upright plane of an edge. Lengths are in pitches.
struct SliceEnd {
  double z;
  double slope;  ///< of its tangent plane: rise for each step from the solid column to the empty
  Vec3 normal;
};

/// Which ends' planes speak of a surface: both, smooth or with a ridge; both, meeting in a hollow
/// that may as well be bent; one, and the other nearly.
enum class Trust { kBoth, kHollow, kOne };

/// Where a surface passes a level between two columns: pitches from the solid one, and the normal.
struct Passage {
  double place;
  Vec3 normal;
  Trust trust;
};

/// Of a surface that runs from end `a` of the solid column to end `b` of the empty one; nothing if
/// their planes do not speak of one surface, smooth or with a crease.
std::optional<Passage> passage(const SliceEnd& a, const SliceEnd& b, double level);

/// The arc of an ellipse with upright axes that a tool's side leaves in the slice, seen from the
/// empty column: what a ball, a rounded corner or the rim of a disc leaves, cut at any angle. In
/// pitches; u grows from the empty column towards the solid one, w from the end `b` into the air.
class SideArc {
 public:
  /// Through end `b` of the empty column and the ends `c` and `d` of the columns behind it, as far
  /// as these lie on one surface: nothing if they do not. `up` is 1 for upper ends, -1 for lower
  /// ones; `towards` points from the empty column to the solid one.
  static std::optional<SideArc> through(const SliceEnd& b, const SliceEnd& c,
                                        const std::optional<SliceEnd>& d, double up, Vec3 towards);

  /// How far from the empty column (u) the arc reaches a height w >= 0. Where it stands upright the
  /// wall goes on as one.
  double way(double w) const;
  /// The outward normal of the solid there.
  Vec3 normal(double w) const;

 private:
  struct Slice {
    double b_slope, c_slope, behind;  ///< rises towards the solid column; `c` above `b`
  };
  static std::optional<SideArc> ellipse(const Slice& slice, const std::optional<double>& d);
  static std::optional<SideArc> circle(const Slice& slice);

  double below_center(double w) const;

  double center_u_ = 0, center_w_ = 0, radius_ = 0;
  double squeeze_ = 1;  ///< height over width of the ellipse; its half height is the radius
  double up_ = 1;
  Vec3 towards_, across_;
  double within_ = 1;  ///< length of the normal's part within the slice
};

}  // namespace kerf
