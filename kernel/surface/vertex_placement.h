// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kernel/surface/column_window.h"
#include "kernel/surface/level_guess.h"
#include "kernel/surface/level_rays.h"
#include "kernel/surface/scratch.h"
#include "kernel/surface/sheet_point.h"
#include "kernel/surface/sheet_table.h"
#include "kernel/surface/vertex_normals.h"

namespace kerf {

/// A cell of the lattice, between columns (x, y) and (x + 1, y + 1) and samples layer - 1 and
/// layer.
struct LatticeCell {
  std::int32_t x = 0, y = 0, layer = 0;
};

/// Returns the configuration of a cell (sheet_table.h). The window must hold its four columns.
std::uint8_t cell_configuration(const ColumnWindow& window, const LatticeCell& cell);

/// Coordinates of a sample of the lattice.
using LatticeSample = std::array<std::int32_t, 3>;

/// The edge of the lattice from sample (i, j, k) to the next along an axis (0, 1, 2).
struct LatticeEdge {
  std::int32_t i = 0, j = 0, k = 0;
  std::uint8_t axis = 2;
};

/// Computes positions and normals of the mesh's vertices. They depend only on nearby rays, so two
/// tiles that compute the same vertex get the same bits.
class VertexPlacement {
 public:
  VertexPlacement(const SolidSnapshot& solid, const ColumnWindow& window);

  /// Returns the vertex of a sheet of a cell. Vertices of one cell do not coincide.
  SurfaceVertex place(const LatticeCell& cell, const CellSheets& sheets, std::uint8_t sheet);

  /// Returns a vertex where the surface crosses an edge, one of whose samples is solid. It is on
  /// the edge to the bit, not at its ends.
  SurfaceVertex place_on_edge(const LatticeEdge& edge);
  /// Returns the center of the fan of a quadrangle: place_on_edge(), but raised into the cells
  /// above a horizontal edge if both corners below are at the edge's height. The envelope below the
  /// edge is then flat, and a triangle in it would be in the plane of the adjacent floor. `corners`
  /// has positions relative to DexelGrid::origin_mm.
  SurfaceVertex place_center(const LatticeEdge& edge,
                             std::span<const std::array<float, 3>, 4> corners);
  /// Returns a position relative to a sample of the lattice, in pitches.
  std::array<double, 3> from_sample(const LatticeSample& sample,
                                    const std::array<float, 3>& position_mm) const;
  /// Returns a position relative to an edge, in pitches. The last coordinate is along the edge,
  /// which reaches from the origin to (0, 0, 1); the axes are right-handed.
  Vec3 beside_edge(const LatticeEdge& edge, const std::array<float, 3>& position_mm) const;

 private:
  /// The crossings of one sheet and their edges.
  struct Crossings {
    std::array<Crossing, 12> at;
    std::array<std::uint8_t, 12> edge{};
    std::size_t count = 0;
  };

  /// A cached crossing of a horizontal edge, which up to four cells share.
  struct SeenEdge {
    std::int32_t i, j, k;
    std::int8_t axis = -1;  ///< 0 along X, 1 along Y, -1 if empty
    Crossing crossing;
  };

  SurfaceVertex place_alone(const LatticeCell& cell, const CellSheets& sheets, std::uint8_t sheet);
  Vec3 mean_on_edges() const;
  /// Returns the least distance of vertices on edges from the edges' ends, in pitches. It exceeds
  /// margin_, so that they are not collinear with vertices at their cells' sides.
  double edge_margin() const { return std::min(2 * margin_, 0.5); }
  bool meets_sheets(const LatticeCell& cell, const CellSheets& sheets) const;
  /// Return the vertex of a cell on a horizontal floor or on the stock's own side without computing
  /// crossings, or nothing for any other cell. Most cells are of these kinds.
  std::optional<SurfaceVertex> place_on_floor(const LatticeCell& cell) const;
  std::optional<SurfaceVertex> place_on_side(const LatticeCell& cell, bool along_x) const;
  SurfaceVertex flat_vertex(Vec3 place, Vec3 normal, bool original) const;
  const SolidRun& run_at(std::int32_t i, std::int32_t j, std::int32_t layer) const;
  bool was_solid(std::int32_t i, std::int32_t j, std::int32_t k) const;
  void find_crossings(const LatticeCell& cell, std::uint16_t edges);
  void upright(const LatticeCell& cell, int dx, int dy, Crossing& crossing) const;
  const Crossing& level(std::int32_t i, std::int32_t j, std::int32_t k, bool along_x);
  CellLimits limits_of(const LatticeCell& cell) const;

  const DexelSnapshot& field_;  ///< along Z
  const ColumnWindow& window_;
  std::optional<LevelRays> rays_;  ///< set if there are three fields
  LevelGuess guess_;
  bool is_box_;                  ///< whether the stock is a box
  Vec3 stock_low_, stock_high_;  ///< in pitches
  double steps_per_mm_;
  double margin_, margin_below_;
  Crossings found_;         ///< of the sheet being placed
  Scratch<SeenEdge> seen_;  ///< by a hash of the edge; a newer entry replaces an older one
};

}  // namespace kerf
