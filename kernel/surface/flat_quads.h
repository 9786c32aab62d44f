// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "kernel/surface/quad_split.h"
#include "kernel/surface/scratch.h"

namespace kerf {

/// The plane of a quadrangle that is perpendicular to an axis. Only quadrangles of one plane can be
/// merged.
struct FlatPlane {
  std::uint8_t axis = 0;      ///< 0, 1, 2: perpendicular to x, y, z
  bool reversed = false;      ///< faces the negative side of the axis
  std::int32_t position = 0;  ///< equal for quadrangles of one plane
  friend auto operator<=>(const FlatPlane&, const FlatPlane&) = default;
};

/// Merges flat quadrangles into rectangles. A rectangle keeps every vertex of its rim, so that
/// adjacent triangles still fit without a crack, and one vertex inside, the center of a fan. The
/// top of an untouched tile has 128 triangles instead of 2048.
class FlatQuads {
 public:
  /// Adds a quadrangle of the plane's grid. Corners at (u, v), (u + 1, v), (u + 1, v + 1), (u, v +
  /// 1), counter-clockwise unless the plane is reversed. `split` is the diagonal to use if it is
  /// not merged.
  void add(const FlatPlane& plane, std::int32_t u, std::int32_t v,
           const std::array<std::uint32_t, 4>& corners, QuadSplit split);
  /// Appends the triangles of all quadrangles. Returns whether any vertex became unused. Rectangles
  /// whose fan would fold, because vertices of creases bend their rim, are not merged.
  bool append_triangles(std::span<const std::array<float, 3>> positions,
                        std::vector<std::uint32_t>& indices) const;

 private:
  struct Quad {
    std::int32_t u, v;
    std::array<std::uint32_t, 4> corners;
    QuadSplit split;
  };
  struct Entry {
    std::uint32_t plane;  ///< number of its plane
    Quad quad;
  };
  struct Plane {
    std::uint32_t number;
    std::uint32_t quads = 0;
  };
  std::map<FlatPlane, Plane> planes_;
  Scratch<Entry> entries_;  ///< in the order of add()
  Plane* last_ = nullptr;
  FlatPlane last_plane_;

  class Grid;
};

}  // namespace kerf
