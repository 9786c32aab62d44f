// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/mesh_placement.h"

#include <cmath>
#include <numbers>

#include "kernel/math/rotation.h"

namespace kerf {
namespace {

/// Sine and cosine of an angle, computed from its distance to the nearest quarter turn.
SinCos sin_cos_deg(double angle_deg) {
  const double quarter = std::round(angle_deg / 90);
  const SinCos rest = sin_cos((angle_deg - 90 * quarter) * (std::numbers::pi / 180));
  switch (static_cast<int>(quarter) & 3) {
    case 0:
      return rest;
    case 1:
      return {rest.cos, -rest.sin};
    case 2:
      return {-rest.sin, -rest.cos};
    default:
      return {-rest.cos, rest.sin};
  }
}

}  // namespace

void place_mesh(TriangleMesh& mesh, const MeshPlacement& placement) {
  if (placement == MeshPlacement{}) return;
  const SinCos a = sin_cos_deg(placement.rotate_deg.x), b = sin_cos_deg(placement.rotate_deg.y),
               c = sin_cos_deg(placement.rotate_deg.z);
  const Vec3 scale = placement.unit_mm * placement.scale;
  for (Vec3& v : mesh.vertices_mm) {
    Vec3 p{v.x * scale.x, v.y * scale.y, v.z * scale.z};
    p = {p.x, a.cos * p.y - a.sin * p.z, a.sin * p.y + a.cos * p.z};
    p = {b.cos * p.x + b.sin * p.z, p.y, b.cos * p.z - b.sin * p.x};
    p = {c.cos * p.x - c.sin * p.y, c.sin * p.x + c.cos * p.y, p.z};
    v = p + placement.translate_mm;
  }
}

}  // namespace kerf
