// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "kernel/math/vec3.h"

namespace kerf {

/// An end of an element in the vertical plane of a lattice edge. Lengths are in pitches.
struct SliceEnd {
  double z;
  double slope;  ///< of its tangent plane: rise per step from the solid column to the empty one
  Vec3 normal;
};

/// Quality of a passage. kBoth: the tangent planes of both ends agree on a surface that is smooth
/// or has a ridge. kHollow: they meet in a hollow, which may also be a curved surface. kOne: the
/// plane of one end nearly passes through the other end.
enum class Trust { kBoth, kHollow, kOne };

/// The point where a surface passes a level between two columns, in pitches from the solid one, and
/// the normal there.
struct Passage {
  double place;
  Vec3 normal;
  Trust trust;
};

/// Computes the passage of a surface from end `a` of the solid column to end `b` of the empty one.
/// Returns nothing if their tangent planes do not fit one surface, smooth or creased.
std::optional<Passage> passage(const SliceEnd& a, const SliceEnd& b, double level);

/// The arc of an ellipse, with vertical and horizontal axes, that a ball, a rounded corner or the
/// rim of a disc leaves in the slice. In pitches, relative to the end `b` of the empty column: u
/// grows towards the solid column, w from the end `b` out of the material.
class SideArc {
 public:
  /// Fits the arc through end `b` of the empty column and the ends `c` and `d` of the columns
  /// behind it. Returns nothing if they are not on one surface. `up` is 1 for upper ends, -1 for
  /// lower ones. `towards` points from the empty column to the solid one.
  static std::optional<SideArc> through(const SliceEnd& b, const SliceEnd& c,
                                        const std::optional<SliceEnd>& d, double up, Vec3 towards);

  /// Returns u, the distance from the empty column, at a height w >= 0. Above the point where the
  /// arc becomes vertical, u is constant: the wall continues vertically.
  double u(double w) const;
  /// Returns the outward normal of the solid at a height w.
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
