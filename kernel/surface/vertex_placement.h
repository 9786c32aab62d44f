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

/// A cell of the lattice: between columns (x, y) and (x + 1, y + 1), and between samples layer - 1
/// and layer.
struct LatticeCell {
  std::int32_t x = 0, y = 0, layer = 0;
};

/// Most normals that a vertex has: of the faces that meet in a corner.
inline constexpr int kVertexNormalsMax = 3;

/// A point of the mesh. Faces on the two sides of a crease see different normals: that of the group
/// to which the lattice edge that they cross belongs.
struct SurfaceVertex {
  std::array<float, 3> position_mm{};  ///< relative to DexelGrid::origin_mm
  std::array<std::array<float, 3>, kVertexNormalsMax> normals{};
  int normal_count = 0;
  std::array<std::uint8_t, 12> group_of_edge{};
  bool sharp = false;
};

/// Decides where the vertices of the mesh lie and which way they look, from the rays near them
/// only, so that two tiles that compute the same vertex get the same bits.
class VertexPlacement {
 public:
  VertexPlacement(const SolidSnapshot& solid, const ColumnWindow& window);

  /// The vertex of a sheet of the cell; no two of a cell coincide.
  SurfaceVertex place(const LatticeCell& cell, const CellSheets& sheets, std::uint8_t sheet);

 private:
  /// The crossings of one sheet, and the edges that they belong to.
  struct Crossings {
    std::array<Crossing, 12> at;
    std::array<std::uint8_t, 12> edge{};
    std::size_t count = 0;
  };

  /// A level edge that has been looked at: up to four cells ask for it.
  struct SeenEdge {
    std::int32_t i, j, k;
    std::int8_t axis = -1;  ///< 0 along X, 1 along Y; -1: none
    Crossing crossing;
  };

  SurfaceVertex place_alone(const LatticeCell& cell, std::uint16_t edges);
  /// Most cells hold a piece of a level floor or of the stock's own side: their vertices need no
  /// crossings. Nothing for any other.
  std::optional<SurfaceVertex> place_on_floor(const LatticeCell& cell) const;
  std::optional<SurfaceVertex> place_on_side(const LatticeCell& cell, bool along_x) const;
  SurfaceVertex flat_vertex(Vec3 place, Vec3 normal) const;
  const SolidRun& run_at(std::int32_t i, std::int32_t j, std::int32_t layer) const;
  void find_crossings(const LatticeCell& cell, std::uint16_t edges);
  void upright(const LatticeCell& cell, int dx, int dy, Crossing& crossing) const;
  const Crossing& level(std::int32_t i, std::int32_t j, std::int32_t k, bool along_x);
  CellLimits limits_of(const LatticeCell& cell) const;

  const ColumnWindow& window_;
  std::optional<LevelRays> rays_;  ///< of a block with three fields
  LevelGuess guess_;
  bool is_box_;                  ///< the stock
  Vec3 stock_low_, stock_high_;  ///< in pitches, as the lattice
  double margin_;
  Crossings found_;         ///< of the sheet that is being placed
  Scratch<SeenEdge> seen_;  ///< by a hash of the edge; a newer one takes an older one's place
};

}  // namespace kerf
