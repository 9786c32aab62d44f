// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/vertex_normals.h"

#include <algorithm>
#include <cstddef>

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Cosine of the angle beyond which two normals belong to different sides of a crease.
constexpr double kCreaseCosine = 0.96;

std::array<float, 3> unit_float(Vec3 sum) {
  // The normals of a thin wall's two faces may cancel. The direction is then arbitrary.
  const Vec3 n = length(sum) > kNormalMin ? normalized(sum) : Vec3{0, 0, 1};
  return {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)};
}

}  // namespace

void group_normals(std::span<const Crossing> crossings, std::span<const std::uint8_t> edges,
                   SurfaceVertex& vertex) {
  const Crossing& one = crossings.front();
  const bool smooth = !one.is_guess() && std::ranges::all_of(crossings, [&](const Crossing& c) {
    return !c.is_guess() && dot(c.normal, one.normal) > kCreaseCosine;
  });
  if (smooth) {
    Vec3 all;
    for (const Crossing& c : crossings) all = all + c.normal;
    vertex.normal_count = 1;
    vertex.normals[0] = unit_float(all);
    vertex.original[0] = std::ranges::all_of(crossings, &Crossing::original);
    return;
  }
  std::array<Vec3, kVertexNormalsMax> first, sum;
  std::size_t count = 0;
  const auto nearest = [&](Vec3 normal) {
    std::size_t best = 0;
    for (std::size_t g = 1; g < count; ++g) {
      if (dot(first[g], normal) > dot(first[best], normal)) best = g;
    }
    return best;
  };
  for (const bool guesses : {false, true}) {
    for (std::size_t n = 0; n < crossings.size(); ++n) {
      const Crossing& c = crossings[n];
      if (c.is_guess() != guesses) continue;
      std::size_t group = nearest(c.normal);
      const bool fits = count > 0 && (guesses || dot(first[group], c.normal) > kCreaseCosine);
      if (!fits && count < kVertexNormalsMax) {
        group = count++;
        first[group] = c.normal;
        sum[group] = {};
        vertex.original[group] = true;
      }
      if (!guesses || !fits) {
        sum[group] = sum[group] + c.normal;
        vertex.original[group] = vertex.original[group] && c.original;
      }
      vertex.group_of_edge[edges[n]] = static_cast<std::uint8_t>(group);
    }
  }
  vertex.normal_count = static_cast<int>(count);
  for (std::size_t g = 0; g < count; ++g) vertex.normals[g] = unit_float(sum[g]);
}

}  // namespace kerf
