// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "kernel/dexel/stock_shape.h"
#include "kernel/surface/column_window.h"
#include "kernel/surface/crossing.h"
#include "kernel/surface/edge_slice.h"

namespace kerf {

/// Columns around an edge that decide where the surface crosses it: edges of cells [first, end)
/// need columns [first - 3, end + 3].
inline constexpr std::int32_t kGuessMargin = 3;

/// Where the surface crosses the edges between neighbouring columns, as far as the ends of the
/// columns and their tangent planes tell. Two ends whose planes meet between the columns belong to
/// one surface, smooth or with a crease, which is known well. Where they do not meet stands a wall
/// that no ray along Z meets: the stock's own side is known; of any other the columns know the
/// place to half a pitch, and a line through where neighbouring rows see it says more.
class LevelGuess {
 public:
  LevelGuess(const ColumnWindow& window, const StockShape& stock)
      : window_(window), stock_(stock) {}

  /// The edge from sample (i, j, k) to the next along X or Y, of which exactly one is solid.
  Crossing find(std::int32_t i, std::int32_t j, std::int32_t k, bool along_x) const;

 private:
  struct Edge;
  struct Ends;
  struct Wall {
    double offset;  ///< pitches from the middle of the edge
    double slope;   ///< of the line through the rows
    int rows;       ///< neighbouring rows that see the wall
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
