// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "kernel/surface/column_window.h"
#include "kernel/surface/sheet_table.h"
#include "kernel/surface/vertex_placement.h"

namespace kerf {

/// Selects cells between two changes of the columns around them: returns the lowest required layer
/// at or above a cell's own.
using NextLayer = std::function<std::int32_t(const LatticeCell&)>;

/// The lattice cells that the surface passes through, within a square of cells. Other cells are not
/// stored.
class LatticeCells {
 public:
  /// Finds the cells (first_x .. first_x + side - 1) x (first_y .. first_y + side - 1). The window
  /// must hold the columns around them that VertexPlacement reads. If `next_needed` is set, wall
  /// cells that it skips are not stored.
  LatticeCells(const ColumnWindow& window, std::int32_t first_x, std::int32_t first_y,
               std::int32_t side, const NextLayer& next_needed = {});

  /// Returns the position of cell (x, y, layer), which must be stored. The stored cells directly
  /// above it follow at consecutive positions.
  std::size_t find(std::int32_t x, std::int32_t y, std::int32_t layer) const;
  LatticeCell cell(std::size_t position, std::int32_t x, std::int32_t y) const {
    return {x, y, layer_[position]};
  }
  const CellSheets& sheets(std::size_t position) const {
    return flipped_[position] ? flipped_sheets_of(configuration_[position])
                              : sheets_of(configuration_[position]);
  }
  /// Returns the face on which a cell joins solid corners (sheet_table.h), or -1.
  int flipped_face(std::size_t position) const {
    return flipped_[position] ? sheets(position).doubled_face : -1;
  }
  std::size_t size() const { return layer_.size(); }

 private:
  void append_cells(std::int32_t x, std::int32_t y, const NextLayer& next_needed);
  void append_cell(std::int32_t x, std::int32_t y, std::int32_t layer, std::uint8_t configuration);
  bool must_flip(const LatticeCell& cell, std::uint8_t configuration) const;

  const ColumnWindow& window_;
  std::int32_t first_x_, first_y_, side_;
  std::vector<std::uint32_t> start_;
  std::vector<std::int32_t> layer_;
  std::vector<std::uint8_t> configuration_;
  std::vector<bool> flipped_;
};

}  // namespace kerf
