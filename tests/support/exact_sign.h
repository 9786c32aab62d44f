// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace kerf::test {

using FloatPoint = std::array<float, 3>;

/// Returns the sign of the volume of the tetrahedron (a, b, c, d), exactly: 1 if d is on the side
/// of the plane (a, b, c) from which these are clockwise, 0 if the points are coplanar.
int orientation(const FloatPoint& a, const FloatPoint& b, const FloatPoint& c, const FloatPoint& d);

/// Returns the sign of the area of the triangle (a, b, c) in the projection along an axis, exactly.
int projected_orientation(const FloatPoint& a, const FloatPoint& b, const FloatPoint& c,
                          std::size_t axis);

/// Returns whether three points are collinear, exactly.
bool are_collinear(const FloatPoint& a, const FloatPoint& b, const FloatPoint& c);

using FloatTriangle = std::array<FloatPoint, 3>;

/// Returns whether two triangles, neither of them degenerate, have a common point other than a
/// common corner or edge, exactly. Touching counts. Corners are common if they are equal.
bool do_intersect(const FloatTriangle& s, const FloatTriangle& t);

}  // namespace kerf::test
