// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "kernel/math/vec3.h"

namespace kerf::demo {

/// Heights (mm) over a rectangle on a regular grid; bilinear between the nodes, constant outside
/// the rectangle.
class HeightMap {
 public:
  /// Samples `height(x, y)` on [min, max] every `pitch_mm`.
  HeightMap(Vec3 min_mm, Vec3 max_mm, double pitch_mm,
            const std::function<double(double, double)>& height);

  double at(double x_mm, double y_mm) const;
  /// Returns the upward unit normal, from central differences over `reach_mm`.
  Vec3 normal(double x_mm, double y_mm, double reach_mm) const;

  /// Returns the offset surface of a ball (drop cutter): the lowest height of the ball's center at
  /// which the ball does not intersect any node of this map. A tool is clear of the surface if
  /// every point of its axis is above the offset surface for its radius.
  HeightMap centers_of_ball(double radius_mm) const;

 private:
  double node(std::ptrdiff_t column, std::ptrdiff_t row) const;

  Vec3 min_mm_;
  double pitch_mm_;
  std::ptrdiff_t columns_, rows_;
  std::vector<double> heights_;  ///< row by row
};

}  // namespace kerf::demo
