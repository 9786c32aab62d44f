// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "server/verify/box_tree.h"

namespace kerf {

/// Computes distances from points to the mesh of a snapshot. Tiles are meshed when a point comes
/// near them, and a limited number of them is kept, so points should be sorted by position. Not
/// thread-safe.
class MeshNearness {
 public:
  explicit MeshNearness(const SolidSnapshot& snapshot);
  /// Returns the distance from the nearest triangle, mm.
  double distance_mm(Vec3 point_mm);

 private:
  using Triangle = std::array<Vec3, 3>;
  struct Tile {
    std::vector<Triangle> triangles;
    BoxTree tree;
  };
  const Tile& tile(std::uint32_t index);

  const SolidSnapshot& snapshot_;
  BoxTree tiles_;
  std::unordered_map<std::uint32_t, Tile> meshed_;
  std::deque<std::uint32_t> oldest_first_;
};

}  // namespace kerf
