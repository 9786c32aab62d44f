// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "kernel/dexel/stock_shape.h"
#include "kernel/surface/column_window.h"
#include "kernel/surface/crossing.h"
#include "kernel/surface/edge_slice.h"

namespace kerf {

/// Number of columns around an edge that LevelGuess reads: edges of cells [first, end) need columns
/// [first - 3, end + 3].
inline constexpr std::int32_t kGuessMargin = 3;

/// Estimates where the surface crosses the horizontal edges between neighboring columns of one
/// field, from the ends of the columns and their tangent planes. Two ends whose planes meet between
/// the columns belong to one surface, smooth or creased, whose crossing is accurate. Otherwise
/// there is a wall that no ray along Z meets. The stock's own sides are known exactly. Any other
/// wall is known to half a pitch, improved by a line fitted through its positions in neighboring
/// rows.
class LevelGuess {
 public:
  LevelGuess(const ColumnWindow& window, const StockShape& stock)
      : window_(window), stock_(stock) {}

  /// Returns the crossing of the edge from sample (i, j, k) to the next along X or Y. Exactly one
  /// of the two samples must be solid.
  Crossing find(std::int32_t i, std::int32_t j, std::int32_t k, bool along_x) const;

 private:
  struct Edge;
  struct Ends;
  struct Wall {
    double offset;  ///< pitches from the midpoint of the edge
    double slope;   ///< of the line through the rows
    int rows;       ///< number of neighboring rows that show the wall
  };

  Ends ends_beside(const Edge& edge) const;
  SliceEnd slice_end(const Edge& edge, const SolidRun& run, bool top) const;
  std::optional<SliceEnd> nearest_end(const Edge& edge, int steps, double z, bool top) const;
  std::optional<Crossing> on_slope(const Edge& edge, const Ends& ends) const;
  std::optional<Crossing> on_arc(const Edge& edge, const Ends& ends, bool arrives) const;
  std::optional<Crossing> on_stock(const Edge& edge) const;
  Crossing on_wall(const Edge& edge, const Ends& ends) const;
  Wall fit_wall(const Edge& edge) const;
  int wall_offset(const Edge& edge, int row) const;

  const ColumnWindow& window_;
  const StockShape& stock_;
};

}  // namespace kerf
