// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/dexel_snapshot.h"

#include <algorithm>
#include <bit>

#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/stock_column.h"
#include "kernel/math/hash.h"

namespace kerf {
namespace {

/// Calls visit(column within the tile, i, j) for the columns of a tile in the grid, until it
/// returns false.
template <class Visit>
void for_columns(const DexelGrid& grid, TileIndex tile, Visit&& visit) {
  const std::int32_t i0 = tile.x * kTileSide, j0 = tile.y * kTileSide;
  const std::int32_t columns = std::min(kTileSide, grid.columns_x - i0);
  const std::int32_t rows = std::min(kTileSide, grid.columns_y - j0);
  for (std::int32_t row = 0; row < rows; ++row) {
    for (std::int32_t c = 0; c < columns; ++c) {
      if (!visit(row * kTileSide + c, i0 + c, j0 + row)) return;
    }
  }
}

/// Returns whether a touched tile still has exactly the stock's shape, because sweeps reached only
/// columns that were already empty.
bool is_like_stock(const DexelTile& tile, TileIndex at, const StockShape& stock,
                   const DexelGrid& grid) {
  bool like = true;
  for_columns(grid, at, [&](int column, std::int32_t i, std::int32_t j) {
    const Dexel whole = stock_column(stock, grid, i, j);
    const auto c = std::size_t(column);
    const std::int32_t length = tile.top[c] - tile.bottom[c];
    like = !tile.is_split(column) && length == whole.top - whole.bottom &&
           (length == 0 || tile.top[c] == whole.top);
    return like;
  });
  return like;
}

void add(Hash& hash, double value) { hash.add(std::bit_cast<std::uint64_t>(value)); }
void add(Hash& hash, std::int32_t a, std::int32_t b) {
  hash.add(std::uint64_t(static_cast<std::uint32_t>(a)) << 32 | static_cast<std::uint32_t>(b));
}

void add(Hash& hash, const DexelGrid& grid, const StockShape& stock) {
  for (const double v :
       {grid.pitch_mm, grid.z_quantum_mm, grid.origin_mm.x, grid.origin_mm.y, grid.origin_mm.z}) {
    add(hash, v);
  }
  add(hash, grid.columns_x, grid.columns_y);
  add(hash, grid.height_quanta, static_cast<std::int32_t>(grid.axis));
  if (const auto* c = std::get_if<CylinderStock>(&stock)) {
    for (const double v : {c->center_x_mm, c->center_y_mm, c->radius_mm}) add(hash, v);
  }
}

}  // namespace

std::span<const Dexel> column_of(const TileDirectory& tiles, const StockShape& stock,
                                 const DexelGrid& grid, std::int32_t i, std::int32_t j,
                                 std::vector<Dexel>& scratch) {
  scratch.clear();
  if (i < 0 || j < 0 || i >= grid.columns_x || j >= grid.columns_y) return scratch;
  if (const DexelTile* tile = tiles.find({i / kTileSide, j / kTileSide})) {
    tile->read((j % kTileSide) * kTileSide + i % kTileSide, scratch);
  } else if (const Dexel whole = stock_column(stock, grid, i, j); whole.bottom < whole.top) {
    scratch.push_back(whole);
  }
  return scratch;
}

DexelSnapshot::DexelSnapshot(const DexelGrid& grid, const StockShape& stock,
                             const ColumnShares& shares, TileDirectory tiles,
                             TileDirectory untouched)
    : grid_(grid),
      stock_(stock),
      shares_(shares),
      tiles_(std::move(tiles)),
      untouched_(std::move(untouched)) {}

ColumnView DexelSnapshot::view_in(const TileDirectory& tiles, std::int32_t i,
                                  std::int32_t j) const {
  ColumnView v;
  if (i < 0 || j < 0 || i >= grid_.columns_x || j >= grid_.columns_y) return v;
  if (const DexelTile* tile = tiles.find({i / kTileSide, j / kTileSide})) {
    return tile->view((j % kTileSide) * kTileSide + i % kTileSide);
  }
  v.topmost = stock_column(stock_, grid_, i, j);
  return v;
}

bool DexelSnapshot::is_original(std::int32_t i, std::int32_t j, std::int32_t depth, bool is_top,
                                NormalCode code) const {
  if (code == kStockNormal) return true;
  if (untouched_.find({i / kTileSide, j / kTileSide}) == nullptr) return false;
  const ColumnView column = untouched_view(i, j);
  const auto ends_there = [&](const Dexel& element) {
    return element.bottom < element.top && (is_top ? element.top : element.bottom) == depth;
  };
  return ends_there(column.topmost) || std::ranges::any_of(column.lower, ends_there);
}

double DexelSnapshot::volume_mm3() const {
  std::int64_t lacking = 0;
  double at_border = 0;  // additional quanta, by the shares
  std::vector<Dexel> scratch;
  const auto add = [&](std::int32_t i, std::int32_t j, std::int64_t solid) {
    const Dexel whole = stock_column(stock_, grid_, i, j);
    const std::int64_t length = whole.top - whole.bottom;
    lacking += length - solid;
    const double by_sides = shares_.of_column(i) * shares_.of_row(j);
    at_border += double(length) * (by_sides - 1) - double(solid) * (shares_.of(i, j) - 1);
    return true;
  };
  tiles_.for_each([&](TileIndex at, const DexelTile& tile) {
    for_columns(grid_, at, [&](int column, std::int32_t i, std::int32_t j) {
      std::int64_t solid = 0;
      tile.read(column, scratch);
      for (const Dexel& d : scratch) solid += d.top - d.bottom;
      return add(i, j, solid);
    });
  });
  // Untouched tiles of a mesh, next to its walls.
  shares_.for_each_tile([&](TileIndex at) {
    if (touched(at)) return;
    for_columns(grid_, at, [&](int, std::int32_t i, std::int32_t j) {
      const Dexel whole = stock_column(stock_, grid_, i, j);
      return add(i, j, whole.top - whole.bottom);
    });
  });
  const double all = stock_quanta(stock_, grid_);
  return (all - static_cast<double>(lacking) - at_border) * grid_.quantum_mm3();
}

std::uint64_t DexelSnapshot::hash() const {
  Hash hash;
  add(hash, grid_, stock_);
  std::vector<Dexel> scratch;
  tiles_.for_each([&](TileIndex at, const DexelTile& tile) {
    if (is_like_stock(tile, at, stock_, grid_)) return;
    add(hash, at.x, at.y);
    for_columns(grid_, at, [&](int column, std::int32_t, std::int32_t) {
      tile.read(column, scratch);
      hash.add(scratch.size());
      for (const Dexel& d : scratch) add(hash, d.bottom, d.top);
      return true;
    });
  });
  return hash.value();
}

}  // namespace kerf
