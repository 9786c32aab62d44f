// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernel/math/vec3.h"

namespace kerf {

/// An indexed triangle mesh, counter-clockwise seen from outside; mm.
struct TriangleMesh {
  std::vector<Vec3> vertices_mm;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  friend bool operator==(const TriangleMesh&, const TriangleMesh&) = default;
};

}  // namespace kerf
