// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "kernel/math/vec3.h"

namespace kerf {

/// The feature of a triangle a b c on which a point lies: a corner, an edge or the inside.
enum class TrianglePart : std::uint8_t { kA, kB, kC, kAb, kBc, kCa, kInside };
struct NearestOnTriangle {
  Vec3 point;
  TrianglePart on;
};

/// Returns the point of a triangle nearest to p (Ericson, Real-Time Collision Detection, 2005,
/// section 5.1.5).
inline NearestOnTriangle nearest_on_triangle(const std::array<Vec3, 3>& t, Vec3 p) {
  const auto [a, b, c] = t;
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {a, TrianglePart::kA};
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {b, TrianglePart::kB};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + ab * (d1 / (d1 - d3)), TrianglePart::kAb};
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {c, TrianglePart::kC};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + ac * (d2 / (d2 - d6)), TrianglePart::kCa};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return {b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), TrianglePart::kBc};
  }
  const double n = 1 / (va + vb + vc);
  return {a + ab * (vb * n) + ac * (vc * n), TrianglePart::kInside};
}

}  // namespace kerf
