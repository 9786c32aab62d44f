// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/dexel/triangle_mesh.h"

namespace kerf {

/// Rows of an affine map. A point is a row on its left (core specification of 3MF, 3.3).
struct ThreemfTransform {
  std::array<double, 12> m{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};

  Vec3 apply(Vec3 v) const {
    return {v.x * m[0] + v.y * m[3] + v.z * m[6] + m[9],
            v.x * m[1] + v.y * m[4] + v.z * m[7] + m[10],
            v.x * m[2] + v.y * m[5] + v.z * m[8] + m[11]};
  }
  /// Applies this map first, then the other.
  ThreemfTransform then(const ThreemfTransform& other) const {
    const Vec3 x{m[0], m[1], m[2]}, y{m[3], m[4], m[5]}, z{m[6], m[7], m[8]};
    const Vec3 zero = other.apply({}), at = other.apply({m[9], m[10], m[11]});
    ThreemfTransform result;
    std::size_t n = 0;
    for (const Vec3 row : {other.apply(x) - zero, other.apply(y) - zero, other.apply(z) - zero, at})
      for (const double c : {row.x, row.y, row.z}) result.m[n++] = c;
    return result;
  }
  bool mirrors() const {
    return dot(cross({m[0], m[1], m[2]}, {m[3], m[4], m[5]}), {m[6], m[7], m[8]}) < 0;
  }
};

/// Use of an object by a component or a build item.
struct ThreemfPlaced {
  std::string part, id;
  ThreemfTransform transform;
};
struct ThreemfObject {
  TriangleMesh mesh;
  std::vector<ThreemfPlaced> components;
  bool is_solid = true;  ///< a model, and not a support or a surface
};
/// One model part of a package.
struct ThreemfPart {
  double unit_mm = 1;
  std::map<std::string, ThreemfObject> objects;
  std::vector<ThreemfPlaced> items;  ///< the build items
};

/// Counts and limits over all parts of a package.
struct ThreemfCount {
  std::uint64_t triangles_max = 0;
  std::uint64_t triangles = 0, vertices = 0;
  std::uint64_t objects = 0;  ///< with components and items
};

/// Parses a model part. `source` passes its text to the given function. Errors of the text name
/// `name` and the line. Rejects large content: more triangles than `count` allows, more vertices
/// than these have corners, more than 100,000 objects, an element of more than 1 MB. Throws
/// MeshRejection.
ThreemfPart read_threemf_part(
    const std::string& name, ThreemfCount& count,
    const std::function<void(const std::function<void(std::string_view)>&)>& source);

/// Returns the name of the part with the model, from the relationships of a package, or an empty
/// text.
std::string threemf_model_part(std::string_view relationships);

}  // namespace kerf
