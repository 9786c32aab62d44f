// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernel/dexel/column_shares.h"
#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/tile_index.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// The hits of rays on a mesh, in one row of tiles and kMargin rows on either side of it.
struct RowsOfMesh {
  static constexpr std::int32_t kMargin = 2, kRows = kTileSide + 2 * kMargin;

  std::int32_t first_row = 0;        ///< of the grid; may be outside of it
  std::vector<double> length;        ///< of the solid in each column, quanta; row-major
  std::vector<std::uint8_t> simple;  ///< 1 if no ray of it has a winding number beyond 1 or -1
};

/// Computes the shares of columns next to steep walls of a mesh. A share is the volume of the solid
/// over a column's square of the pitch, and over the squares of neighbors without solid, divided by
/// the volume of the column. So a wall between two rays counts at its position, to the accuracy of
/// the mesh.
class MeshShares {
 public:
  /// Both must outlive this object.
  MeshShares(const DexelGrid& grid, const RowsOfMesh& rows);

  /// Adds a triangle of the closed mesh, in the field's frame. Triangles that do not reach the rows
  /// may be left out.
  void add(const std::array<Vec3, 3>& corners);
  /// Computes the shares of the columns of a tile, after all triangles have been added. `sides` has
  /// the shares of all other columns. Returns false if no wall is near.
  bool of_tile(TileIndex tile, const ColumnShares& sides, ColumnShares::OfTile& shares) const;

 private:
  std::size_t place(std::int32_t i, std::int32_t row) const {
    return std::size_t(row) * std::size_t(grid_.columns_x) + std::size_t(i);
  }
  bool is_inside(std::int32_t i, std::int32_t row) const;
  bool is_near_wall(std::int32_t i, std::int32_t row) const;
  std::int32_t taker(std::int32_t i, std::int32_t row) const;
  double share(std::int32_t i, std::int32_t row) const;

  const DexelGrid& grid_;
  const RowsOfMesh& rows_;
  std::vector<std::uint8_t> near_;  ///< 1 if next to a wall
  std::vector<double> volume_;      ///< over each square that is near_; in squares of the pitch, mm
};

}  // namespace kerf
