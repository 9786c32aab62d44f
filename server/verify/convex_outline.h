// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace kerf {

struct IndexedMesh;

/// The convex hull of a mesh seen along Z: the least region of which it is certain that a blank for
/// the part covers it.
class ConvexOutline {
 public:
  /// A mesh without triangles covers nothing.
  explicit ConvexOutline(const IndexedMesh& mesh);

  /// Whether a point is in the outline or on its border. mm, in the scene's coordinates.
  bool contains(double x_mm, double y_mm) const;

 private:
  struct Point {
    double x, y;
  };
  /// Twice the area of the triangle, positive if it turns counter-clockwise.
  static double turn(Point a, Point b, Point c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }

  std::vector<Point> corners_;  ///< counter-clockwise
};

}  // namespace kerf
