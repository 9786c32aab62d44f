// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernel/surface/column_window.h"
#include "kernel/surface/sheet_table.h"
#include "kernel/surface/vertex_placement.h"

namespace kerf {

/// The lattice cells that the surface runs through, for a square of cells; only those are stored.
class LatticeCells {
 public:
  /// Cells (first_x .. first_x + side - 1) x (first_y ..); the window must hold the columns of
  /// placement around them.
  LatticeCells(const ColumnWindow& window, std::int32_t first_x, std::int32_t first_y,
               std::int32_t side);

  /// Position of cell (x, y, layer), which must be one that the surface runs through. The surface
  /// cells above it up to the next gap follow one by one.
  std::size_t find(std::int32_t x, std::int32_t y, std::int32_t layer) const;
  LatticeCell cell(std::size_t position, std::int32_t x, std::int32_t y) const {
    return {x, y, layer_[position]};
  }
  const CellSheets& sheets(std::size_t position) const {
    return flipped_[position] ? flipped_sheets_of(configuration_[position])
                              : sheets_of(configuration_[position]);
  }
  std::size_t size() const { return layer_.size(); }

 private:
  void append_cells(std::int32_t x, std::int32_t y);
  void append_cell(std::int32_t x, std::int32_t y, std::int32_t layer, std::uint8_t configuration);
  std::uint8_t configuration_of(const LatticeCell& cell) const;
  bool must_flip(const LatticeCell& cell, std::uint8_t configuration) const;

  const ColumnWindow& window_;
  std::int32_t first_x_, first_y_, side_;
  std::vector<std::uint32_t> start_;
  std::vector<std::int32_t> layer_;
  std::vector<std::uint8_t> configuration_;
  std::vector<bool> flipped_;
};

}  // namespace kerf
