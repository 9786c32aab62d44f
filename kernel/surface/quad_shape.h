// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace kerf {

/// The corners of a quadrangle, counter-clockwise about its lattice edge.
struct QuadShape {
  std::array<std::array<float, 3>, 4> positions_mm{}, normals{};
  bool sharp = false;  ///< a corner lies on a crease
};

/// Returns whether positions and normals are perpendicular to the axis to the last bit.
bool is_flat(const QuadShape& quad, std::size_t axis);

/// Returns whether the corners of a flat quadrangle have equal coordinates in pairs: then both
/// diagonals fit.
bool is_rectangle(const QuadShape& quad, std::size_t axis);

/// Returns whether to split a quadrangle from its second to its fourth corner. That is the shorter
/// diagonal, or, next to a crease, the one that leaves a triangle perpendicular to the surface's
/// normal, so that no triangle spans the crease. `reversed`: the surface faces down its edge.
bool prefers_other_diagonal(QuadShape quad, bool reversed);

}  // namespace kerf
