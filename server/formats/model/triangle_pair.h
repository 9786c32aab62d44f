// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace kerf {

/// The corners of a triangle.
using FloatTriangle = std::array<std::array<float, 3>, 3>;

/// Returns whether the corners of a triangle are collinear, exactly.
bool has_no_area(const FloatTriangle& t);

/// Returns whether two triangles with area have a common point other than a common corner or edge,
/// exactly: touching counts. Corners are common if they are equal. Signs of determinants are
/// computed in doubles if a bound on the rounding error decides them, else without rounding (J.
/// Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates,
/// 1997).
bool do_cross(const FloatTriangle& s, const FloatTriangle& t);

}  // namespace kerf
