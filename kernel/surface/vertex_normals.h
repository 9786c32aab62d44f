// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "kernel/surface/crossing.h"

namespace kerf {

/// Greatest number of normals of a vertex: the number of faces that meet in a corner.
inline constexpr int kVertexNormalsMax = 3;

/// A vertex of the mesh. Faces on different sides of a crease use different normals: that of the
/// group of the lattice edge that they cross.
struct SurfaceVertex {
  std::array<float, 3> position_mm{};  ///< relative to DexelGrid::origin_mm
  std::array<std::array<float, 3>, kVertexNormalsMax> normals{};
  std::array<bool, kVertexNormalsMax> original{};  ///< per normal: belongs to the untouched stock
  int normal_count = 0;
  std::array<std::uint8_t, 12> group_of_edge{};
  bool sharp = false;
};

/// Sets a vertex's normals: one for each side of a crease, the mean of its crossings. Estimated
/// crossings form a group of their own only if all are estimates. A side is original if all
/// crossings that determine its normal are. `edges` has the lattice edge of each crossing.
void group_normals(std::span<const Crossing> crossings, std::span<const std::uint8_t> edges,
                   SurfaceVertex& vertex);

}  // namespace kerf
