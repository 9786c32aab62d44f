// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernel/tool/tool.h"

namespace kerf {

/// The outline of a tool in the half-plane (radius, height above the tip), which revolves about the
/// axis to its surface. The pieces of a tool overlap and meet in discs that are not surface. Only
/// the outer border is kept, so the distance to it is exact inside the tool too.
class ToolProfile {
 public:
  explicit ToolProfile(const Tool& tool);

  /// The nearest point of the border.
  struct Nearest {
    double distance_mm;                  ///< negative inside the tool
    double normal_radial, normal_along;  ///< unit; direction in which the distance grows
  };
  Nearest nearest(double radial_mm, double height_mm) const;
  /// A point of the outline and its unit normal, out of the tool.
  struct OutlinePoint {
    double radial_mm, height_mm;
    double normal_radial, normal_along;
  };
  /// Returns the length of the outline from the tip up to a height, mm, or 0 if that is not
  /// positive.
  double outline_length(double up_to_mm) const;
  /// Returns the point at a distance along the outline from the tip; its end if it is shorter.
  OutlinePoint outline_at(double along_mm) const;
  /// Returns the greatest radius, mm.
  double radius_mm() const { return radius_mm_; }
  /// Whether the tool is a convex body, so that its distance along a straight motion has one
  /// minimum.
  bool convex() const { return convex_; }

 private:
  struct Point {
    double r, h;
  };
  /// A straight part from a to b, or (radius > 0) the outer side of an arc between their heights.
  struct Part {
    Point a, b;
    Point center{0, 0};
    double radius = 0;
  };
  void add_outline(const ToolPiece& piece, double low_mm, double high_mm);
  void add_step(double from_r, double to_r, double height_mm);
  double radius_at(double height_mm) const;
  bool is_convex() const;
  static Point at_share(const Part& part, double share);
  static double length_of(const Part& part);
  static Point nearest_on(const Part& part, Point p);
  static Point normal_of(const Part& part, Point q);

  std::vector<Part> parts_;
  std::vector<ToolPiece> pieces_;
  double low_mm_ = 0, high_mm_ = 0, radius_mm_ = 0;
  bool convex_ = false;
};

}  // namespace kerf
