// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <map>
#include <vector>

#include "kernel/surface/scratch.h"

namespace kerf {

/// Where a quadrangle lies that is flat and square to an axis: only those of one plane can be
/// joined.
struct FlatPlane {
  std::uint8_t axis = 0;      ///< 0, 1, 2: square to x, y, z
  bool reversed = false;      ///< looks towards the negative side of the axis
  std::int32_t position = 0;  ///< equal for quadrangles of one plane
  friend auto operator<=>(const FlatPlane&, const FlatPlane&) = default;
};

/// Joins flat quadrangles into rectangles that keep every vertex of their rim, so that whatever is
/// next to them still fits without a crack, and none inside but one. An untouched tile's top costs
/// 128 triangles instead of 2048.
class FlatQuads {
 public:
  /// A quadrangle of the plane's grid. Corners at (u, v), (u + 1, v), (u + 1, v + 1), (u, v + 1),
  /// counter-clockwise unless the plane is reversed.
  void add(const FlatPlane& plane, std::int32_t u, std::int32_t v,
           const std::array<std::uint32_t, 4>& corners);
  /// Appends the triangles of all quadrangles; true if any vertex was left out.
  bool append_triangles(std::vector<std::uint32_t>& indices) const;

 private:
  struct Quad {
    std::int32_t u, v;
    std::array<std::uint32_t, 4> corners;
  };
  struct Entry {
    std::uint32_t plane;  ///< its number
    Quad quad;
  };
  struct Plane {
    std::uint32_t number;
    std::uint32_t quads = 0;
  };
  std::map<FlatPlane, Plane> planes_;
  Scratch<Entry> entries_;  ///< as they came
  Plane* last_ = nullptr;
  FlatPlane last_plane_;

  class Grid;
};

}  // namespace kerf
