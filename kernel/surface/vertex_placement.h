// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "kernel/surface/column_window.h"
#include "kernel/surface/level_guess.h"
#include "kernel/surface/level_rays.h"
#include "kernel/surface/scratch.h"
#include "kernel/surface/sheet_point.h"
#include "kernel/surface/sheet_table.h"

namespace kerf {

/// A cell of the lattice, between columns (x, y) and (x + 1, y + 1) and samples layer - 1 and
/// layer.
struct LatticeCell {
  std::int32_t x = 0, y = 0, layer = 0;
};

/// Greatest number of normals of a vertex: the faces that meet in a corner.
inline constexpr int kVertexNormalsMax = 3;

/// A vertex of the mesh. Faces on different sides of a crease use different normals: that of the
/// group of the lattice edge that they cross.
struct SurfaceVertex {
  std::array<float, 3> position_mm{};  ///< relative to DexelGrid::origin_mm
  std::array<std::array<float, 3>, kVertexNormalsMax> normals{};
  int normal_count = 0;
  std::array<std::uint8_t, 12> group_of_edge{};
  bool sharp = false;
};

/// Computes positions and normals of the mesh's vertices. They depend only on nearby rays, so two
/// tiles that compute the same vertex get the same bits.
class VertexPlacement {
 public:
  VertexPlacement(const SolidSnapshot& solid, const ColumnWindow& window);

  /// Returns the vertex of a sheet of a cell. Vertices of one cell do not coincide.
  SurfaceVertex place(const LatticeCell& cell, const CellSheets& sheets, std::uint8_t sheet);

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
    std::int8_t axis = -1;  ///< 0 along X, 1 along Y; -1: none
    Crossing crossing;
  };

  SurfaceVertex place_alone(const LatticeCell& cell, std::uint16_t edges);
  /// Return the vertex of a cell on a horizontal floor or on the stock's own side, which most cells
  /// are, without computing crossings; nothing for any other cell.
  std::optional<SurfaceVertex> place_on_floor(const LatticeCell& cell) const;
  std::optional<SurfaceVertex> place_on_side(const LatticeCell& cell, bool along_x) const;
  SurfaceVertex flat_vertex(Vec3 place, Vec3 normal) const;
  const SolidRun& run_at(std::int32_t i, std::int32_t j, std::int32_t layer) const;
  void find_crossings(const LatticeCell& cell, std::uint16_t edges);
  void upright(const LatticeCell& cell, int dx, int dy, Crossing& crossing) const;
  const Crossing& level(std::int32_t i, std::int32_t j, std::int32_t k, bool along_x);
  CellLimits limits_of(const LatticeCell& cell) const;

  const ColumnWindow& window_;
  std::optional<LevelRays> rays_;  ///< set if there are three fields
  LevelGuess guess_;
  bool is_box_;                  ///< whether the stock is a box
  Vec3 stock_low_, stock_high_;  ///< in pitches
  double margin_, margin_below_;
  Crossings found_;         ///< of the sheet being placed
  Scratch<SeenEdge> seen_;  ///< by a hash of the edge; a newer entry replaces an older one
};

}  // namespace kerf
