// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/quad_shape.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/math/tolerance.h"
#include "kernel/math/vec3.h"

namespace kerf {
namespace {

Vec3 difference(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return {double(a[0]) - double(b[0]), double(a[1]) - double(b[1]), double(a[2]) - double(b[2])};
}

float distance_squared(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  const float x = a[0] - b[0];
  const float y = a[1] - b[1];
  const float z = a[2] - b[2];
  return x * x + y * y + z * z;
}

}  // namespace

bool prefers_other_diagonal(QuadShape quad, bool reversed) {
  auto& p = quad.positions_mm;
  if (reversed) {
    std::swap(p[1], p[3]);
    std::swap(quad.normals[1], quad.normals[3]);
  }
  const bool shorter = distance_squared(p[1], p[3]) < distance_squared(p[0], p[2]);
  if (!quad.sharp) return shorter;
  Vec3 normal;
  for (const auto& n : quad.normals) {
    normal = normal + Vec3{double(n[0]), double(n[1]), double(n[2])};
  }
  const auto fit = [&](std::size_t a, std::size_t b, std::size_t d) {
    const Vec3 square = cross(difference(p[b], p[a]), difference(p[d], p[a]));
    const double size = length(square);
    return size > 0 ? dot(square, normal) / size : 0;
  };
  const double here = std::max(fit(0, 1, 2), fit(0, 2, 3));
  const double there = std::max(fit(1, 2, 3), fit(1, 3, 0));
  const double indifferent = kFitEpsilon * length(normal);
  return std::abs(here - there) <= indifferent ? shorter : there > here;
}

}  // namespace kerf
