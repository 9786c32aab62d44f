// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace kerf {

/// Numbers of the vertices of a quadrangle, counter-clockwise about its lattice edge.
using QuadCorners = std::array<std::uint32_t, 4>;

/// Returns whether the positions and normals of a quadrangle's corners are perpendicular to the
/// axis to the last bit.
inline bool is_flat(std::span<const std::array<float, 3>> positions,
                    std::span<const std::array<float, 3>> normals, const QuadCorners& c,
                    std::size_t axis) {
  for (const std::uint32_t v : c) {
    if (positions[v][axis] != positions[c[0]][axis]) return false;
    if (std::abs(normals[v][axis]) != 1) return false;
  }
  return true;
}

/// Returns whether the corners of a flat quadrangle have equal coordinates in pairs, so that both
/// diagonals fit.
inline bool is_rectangle(std::span<const std::array<float, 3>> positions, const QuadCorners& c,
                         std::size_t axis) {
  const auto equal = [&](std::size_t a, std::size_t b, std::size_t along) {
    return positions[c[a]][along] == positions[c[b]][along];
  };
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  const auto fits = [&](std::size_t s, std::size_t t) {
    return equal(0, 3, s) && equal(1, 2, s) && equal(0, 1, t) && equal(2, 3, t);
  };
  return fits(u, v) || fits(v, u);
}

/// The corners of a quadrangle, counter-clockwise about its lattice edge.
struct QuadShape {
  std::array<std::array<float, 3>, 4> positions_mm{}, normals{};
  bool sharp = false;  ///< a corner is on a crease
};

/// Returns whether to split a quadrangle from its second to its fourth corner. That is the shorter
/// diagonal, or, next to a crease, the one that leaves a triangle perpendicular to the surface's
/// normal, so that no triangle spans the crease. `reversed` states that the surface faces down its
/// edge.
bool prefers_other_diagonal(QuadShape quad, bool reversed);

}  // namespace kerf
