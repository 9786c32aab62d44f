// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "kernel/math/vec3.h"

namespace kerf {

/// The triangles of a quadrangle with corners 0 to 3: two at the diagonal between corners 0 and 2
/// or 1 and 3, or four that meet in a vertex on the quadrangle's lattice edge.
enum class QuadSplit { kFirst, kSecond, kFan };

/// Chooses the triangles of the quadrangle around a lattice edge so that they stay within the
/// edge's envelope: the four tetrahedra between the edge and each two neighboring corners.
/// Envelopes of different edges have disjoint interiors where each cell has one vertex, so
/// triangles within them do not intersect (T. Ju, T. Udeshi, Intersection-free contouring on an
/// octree grid, 2006). Returns the preferred diagonal if it fits, else the other one, else the fan.
/// `corners` has one corner in each of the four cells around the edge, counter-clockwise about it,
/// in coordinates (a, b, h) in pitches in which the edge reaches from the origin to (0, 0, 1).
/// `flat` states that the corners are in a plane across the edge, which may pass through the edge's
/// end.
QuadSplit split_within_envelope(const std::array<Vec3, 4>& corners, bool flat, QuadSplit preferred);

}  // namespace kerf
