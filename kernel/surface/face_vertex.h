// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "kernel/surface/column_window.h"
#include "kernel/surface/lattice_cells.h"
#include "kernel/surface/vertex_placement.h"

namespace kerf {

/// Places vertices on faces between cells if a cell has several sheets. The segment between the
/// vertices of two neighboring cells must then pass their common face on the sheet's own side, next
/// to the sample that the sheet cuts off. If it does not, the sheet is bent at a vertex on the
/// face, so that the parts of different sheets in a cell have disjoint convex hulls.
class FaceVertices {
 public:
  /// All must outlive this object.
  FaceVertices(const ColumnWindow& window, const LatticeCells& cells, VertexPlacement& placement)
      : window_(window), cells_(cells), placement_(placement) {}

  /// Per corner: the vertex between it and the next one, or nothing if their segment passes the
  /// face on the correct side.
  using OfQuad = std::array<std::optional<SurfaceVertex>, 4>;
  /// A position relative to DexelGrid::origin_mm.
  using Position = std::array<float, 3>;
  using Corners = std::array<Position, 4>;
  /// Finds the vertices between the corners of the quadrangle around an edge. `cells` has the
  /// positions of the four cells, counter-clockwise about the edge, and `corners` their vertices.
  /// Returns whether there are any. The two quadrangles at a segment get the same vertex, to the
  /// bit.
  bool find(const LatticeEdge& edge, const std::array<std::size_t, 4>& cells,
            const Corners& corners, OfQuad& between);

 private:
  std::optional<SurfaceVertex> after(const LatticeEdge& edge,
                                     const std::array<std::size_t, 4>& cells,
                                     const Corners& corners, std::size_t n);
  /// Returns a position between two crossings, midway or nearer to the first: within half a pitch
  /// of it, and so of the surface.
  Position between_crossings(const Position& first, const Position& second) const;
  /// Returns whether a segment passes the face at `sample` that is perpendicular to the axis
  /// `across` in the half next to the sample. `lower` is the end below the face. Both quadrangles
  /// at the segment compute this from the same numbers in the same order, so that rounding decides
  /// a tie alike.
  bool passes_near(const LatticeSample& sample, std::size_t across, const Position& lower,
                   const Position& upper) const;
  bool solid(const LatticeSample& sample) const {
    return window_.solid(sample[0], sample[1], sample[2]);
  }

  const ColumnWindow& window_;
  const LatticeCells& cells_;
  VertexPlacement& placement_;
};

}  // namespace kerf
