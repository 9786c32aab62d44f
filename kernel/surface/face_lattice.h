// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "kernel/dexel/tile_index.h"

namespace kerf {

/// A side of the stock's box, perpendicular to an axis (0, 1, 2: x, y, z).
struct StockFace {
  std::uint8_t axis = 2;
  bool high = true;  ///< faces the axis' positive end

  std::size_t u_axis() const { return (axis + 1U) % 3; }
  std::size_t v_axis() const { return (axis + 2U) % 3; }
  /// Returns a number from 0 to 5.
  std::size_t index() const { return 2U * axis + (high ? 1U : 0U); }
};

inline constexpr std::array<StockFace, 6> kStockFaces{
    {{0, false}, {0, true}, {1, false}, {1, true}, {2, false}, {2, true}}};

/// Coordinates by axis: numbers of quadrangles, of patches, or of vertices.
using LatticePoint = std::array<std::int32_t, 3>;

/// A rectangle [low, high) of a face; entries of the face's own axis have no meaning.
struct FaceRange {
  StockFace face;
  LatticePoint low{}, high{};

  bool is_empty() const {
    const std::size_t u = face.u_axis(), v = face.v_axis();
    return low[u] >= high[u] || low[v] >= high[v];
  }
  /// Returns the range enlarged by `margin` on all four sides.
  FaceRange grown(std::int32_t margin) const {
    FaceRange r = *this;
    for (const std::size_t axis : {face.u_axis(), face.v_axis()}) {
      r.low[axis] -= margin;
      r.high[axis] += margin;
    }
    return r;
  }
  /// Returns the part within a box of `size`.
  FaceRange within(const LatticePoint& size) const {
    FaceRange r = *this;
    for (const std::size_t axis : {face.u_axis(), face.v_axis()}) {
      r.low[axis] = std::max(low[axis], 0);
      r.high[axis] = std::min(high[axis], size[axis]);
    }
    return r;
  }
};

/// Calls visit(FaceRange) for the part of a range on its face and for the parts that protrude
/// beyond the face's sides, folded onto the adjacent faces of a box of `size`.
template <class Visit>
void for_unfolded(const FaceRange& range, const LatticePoint& size, Visit&& visit) {
  const FaceRange inside = range.within(size);
  if (inside.is_empty()) return;
  visit(inside);
  const StockFace from = range.face;
  for (const std::size_t axis : {from.u_axis(), from.v_axis()}) {
    for (const bool high : {false, true}) {
      const std::int32_t depth = high ? range.high[axis] - size[axis] : -range.low[axis];
      if (depth <= 0) continue;
      FaceRange folded = inside;
      folded.face = {static_cast<std::uint8_t>(axis), high};
      const std::int32_t end = size[from.axis];
      folded.low[from.axis] = from.high ? std::max(end - depth, 0) : 0;
      folded.high[from.axis] = from.high ? end : std::min(depth, end);
      visit(folded);
    }
  }
}

/// A square of 2^level x 2^level patches of a face: patches (u << level, v << level) onwards. A
/// patch is the part of a face that belongs to one tile of columns, or of samples: kTileSide x
/// kTileSide quadrangles.
struct FaceNode {
  int level = 0;
  std::int32_t u = 0, v = 0;

  /// Returns those of the node's patches that exist, according to `patches`.
  FaceRange range(StockFace face, const LatticePoint& patches) const {
    FaceRange r{face, {}, {}};
    r.low[face.u_axis()] = u << level;
    r.low[face.v_axis()] = v << level;
    r.high[face.u_axis()] = (u + 1) << level;
    r.high[face.v_axis()] = (v + 1) << level;
    return r.within(patches);
  }
};

/// Returns the number of patches that cover `quads` quadrangles, by axis.
inline LatticePoint patches_of(const LatticePoint& quads) {
  LatticePoint patches{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    patches[axis] = (quads[axis] + kTileSide - 1) / kTileSide;
  }
  return patches;
}

}  // namespace kerf
