// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/signed_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "kernel/force/triangle_tree.h"
#include "kernel/math/nearest_on_triangle.h"
#include "kernel/math/rotation.h"

namespace kerf {

SignedDistance signed_distance(const BoxObstacle& box, Vec3 p) {
  const Vec3 near{std::clamp(p.x, box.min_mm.x, box.max_mm.x),
                  std::clamp(p.y, box.min_mm.y, box.max_mm.y),
                  std::clamp(p.z, box.min_mm.z, box.max_mm.z)};
  const Vec3 away = p - near;
  const double outside = length(away);
  if (outside > 0) return {outside, away * (1 / outside)};
  SignedDistance best{-1e300, {}};
  const std::array<SignedDistance, 6> faces{{{box.min_mm.x - p.x, {-1, 0, 0}},
                                             {p.x - box.max_mm.x, {1, 0, 0}},
                                             {box.min_mm.y - p.y, {0, -1, 0}},
                                             {p.y - box.max_mm.y, {0, 1, 0}},
                                             {box.min_mm.z - p.z, {0, 0, -1}},
                                             {p.z - box.max_mm.z, {0, 0, 1}}}};
  for (const SignedDistance& face : faces) {
    if (face.distance_mm > best.distance_mm) best = face;
  }
  return best;
}

SignedDistance signed_distance(const CylinderObstacle& c, Vec3 p) {
  const Vec3 axis = c.to_mm - c.from_mm;
  const double n = length(axis);
  const Vec3 u = axis * (1 / n);
  const Vec3 rel = p - c.from_mm;
  const double along = dot(rel, u);
  const Vec3 across = rel - u * along;
  const double r = length(across);
  const Vec3 radial = r > 0 ? across * (1 / r) : any_perpendicular(u);
  const double side = r - c.radius_mm;
  const double end = std::max(-along, along - n);
  const Vec3 cap = along < n / 2 ? -u : u;
  if (side <= 0 || end <= 0) {
    return side > end ? SignedDistance{side, radial} : SignedDistance{end, cap};
  }
  const double d = std::sqrt(side * side + end * end);
  return {d, radial * (side / d) + cap * (end / d)};
}

SignedDistance signed_distance(const SphereObstacle& s, Vec3 p) {
  const Vec3 away = p - s.center_mm;
  const double d = length(away);
  return {d - s.radius_mm, d > 0 ? away * (1 / d) : Vec3{0, 0, 1}};
}

SignedDistance signed_distance(const MeshObstacle& mesh, Vec3 p) {
  const TriangleTree::Found found = mesh.tree->find(p);
  const auto& t = mesh.triangles[found.nearest];
  const Vec3 away = p - nearest_on_triangle(t, p).point;
  const double d = std::sqrt(dot(away, away));
  if (d == 0) return {0, normalized(cross(t[1] - t[0], t[2] - t[0]))};
  return found.inside ? SignedDistance{-d, away * (-1 / d)} : SignedDistance{d, away * (1 / d)};
}

SignedDistance signed_distance(const Obstacle& obstacle, Vec3 p) {
  return std::visit([&](const auto& shape) { return signed_distance(shape, p); }, obstacle.shape);
}

}  // namespace kerf
