// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "kernel/math/vec3.h"

namespace kerf {

/// The sum of squared distances of a point from planes, each with a weight, as a quadratic form
/// (Garland, Heckbert, Surface simplification using quadric error metrics, 1997).
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, x = 0, y = 0, z = 0, one = 0, weight = 0;

  /// `n` is the unit normal of the plane, `point` one of its points.
  static Quadric of_plane(Vec3 n, Vec3 point, double weight) {
    const double d = -dot(n, point), w = weight;
    return {w * n.x * n.x,
            w * n.x * n.y,
            w * n.x * n.z,
            w * n.y * n.y,
            w * n.y * n.z,
            w * n.z * n.z,
            w * n.x * d,
            w * n.y * d,
            w * n.z * d,
            w * d * d,
            w};
  }
  Quadric& operator+=(const Quadric& o) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    x += o.x, y += o.y, z += o.z, one += o.one, weight += o.weight;
    return *this;
  }
  /// The mean squared distance of a point from the planes, mm².
  double operator()(Vec3 p) const {
    const double sum = p.x * (xx * p.x + 2 * (xy * p.y + xz * p.z + x)) +
                       p.y * (yy * p.y + 2 * (yz * p.z + y)) + p.z * (zz * p.z + 2 * z) + one;
    return weight > 0 ? std::max(sum, 0.0) / weight : 0;
  }
};

}  // namespace kerf
