#include "kernel/dexel/dexel_field.h"

#include <algorithm>

#include "kernel/dexel/stock_column.h"

namespace kerf {

DexelField::DexelField(const StockShape& stock, double pitch_mm, RayAxis axis)
    : stock_(stock),
      grid_(make_grid(stock, pitch_mm, axis)),
      tiles_(std::size_t(grid_.tiles_x()) * std::size_t(grid_.tiles_y())) {}

DexelTile& DexelField::edit(TileIndex tile) {
  std::shared_ptr<DexelTile>& slot = tiles_[index(tile)];
  if (!slot) {
    slot = make_tile(tile);
  } else if (slot->era != era_) {
    slot = std::make_shared<DexelTile>(*slot);
  }
  slot->era = era_;
  return *slot;
}

std::shared_ptr<DexelTile> DexelField::make_tile(TileIndex tile) const {
  auto made = std::make_shared<DexelTile>();
  made->bottom.fill(0);
  made->top.fill(0);
  for (int row = 0; row < kTileSide; ++row) {
    const std::int32_t j = tile.y * kTileSide + row;
    for (int c = 0; c < kTileSide; ++c) {
      const std::int32_t i = tile.x * kTileSide + c;
      if (i >= grid_.columns_x || j >= grid_.columns_y) continue;
      const Dexel whole = stock_column(stock_, grid_, i, j);
      if (whole.bottom >= whole.top) continue;
      made->bottom[std::size_t(row * kTileSide + c)] = whole.bottom;
      made->top[std::size_t(row * kTileSide + c)] = whole.top;
      made->top_max = std::max(made->top_max, whole.top);
    }
  }
  return made;
}

DexelSnapshot DexelField::snapshot() {
  ++era_;
  return {grid_, stock_, {tiles_.begin(), tiles_.end()}};
}

double DexelField::stock_volume_mm3() const {
  std::int64_t quanta = 0;
  if (std::holds_alternative<BoxStock>(stock_)) {
    quanta = std::int64_t{grid_.columns_x} * grid_.columns_y * grid_.height_quanta;
  } else {
    for (std::int32_t j = 0; j < grid_.columns_y; ++j) {
      for (std::int32_t i = 0; i < grid_.columns_x; ++i) {
        const Dexel whole = stock_column(stock_, grid_, i, j);
        quanta += whole.top - whole.bottom;
      }
    }
  }
  return static_cast<double>(quanta) * grid_.z_quantum_mm * grid_.pitch_mm * grid_.pitch_mm;
}

}  // namespace kerf
