// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "kernel/surface/face_cover.h"
#include "kernel/surface/lattice_cells.h"

namespace kerf {

/// Selects the quadrangles that remain in a tile's mesh if the stock's faces are covered: those of
/// open patches, and all that are not on a face.
class OpenPatches {
 public:
  /// `cover` may be null, which leaves every patch open.
  OpenPatches(const FaceCover* cover, const DexelGrid& grid, TileIndex tile)
      : cover_(cover), columns_x_(grid.columns_x), columns_y_(grid.columns_y), tile_(tile) {
    bottom_ = !is_covered({2, false}, tile.x, tile.y);
    top_ = !is_covered({2, true}, tile.x, tile.y);
  }

  /// Returns whether the mesh has the bottom of an element whose first sample is `first`.
  bool has_bottom(std::int32_t first) const { return bottom_ || first > 0; }
  /// Returns whether the mesh has the top of an element below sample `end`.
  bool has_top(std::int32_t end) const { return top_ || end < cover_->quads()[2]; }

  /// Returns the stock's side between column (i, j) and its next neighbor, one of which is outside
  /// the grid. Returns nothing if neither is, or if no side is covered.
  std::optional<StockFace> side_between(std::int32_t i, std::int32_t j, bool along_x) const;
  /// A range [first, end) of samples.
  struct Samples {
    std::int32_t first, end;
  };
  /// Returns the first samples within [first, end) that are in open patches of a side, or an empty
  /// range if there are none.
  Samples next(const std::optional<StockFace>& side, std::int32_t first, std::int32_t end) const;
  /// Returns the selection of the cells that have a quadrangle, or an empty function if all have.
  NextLayer next_layer() const;

 private:
  bool is_covered(StockFace face, std::int32_t u, std::int32_t v) const {
    return cover_ != nullptr && cover_->is_active(face) && cover_->covers(face, u, v);
  }
  bool is_covered_at(StockFace side, std::int32_t sample) const;

  const FaceCover* cover_;
  std::int32_t columns_x_, columns_y_;
  TileIndex tile_;
  bool bottom_, top_;
};

}  // namespace kerf
