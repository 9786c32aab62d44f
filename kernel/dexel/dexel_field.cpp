#include "kernel/dexel/dexel_field.h"

#include "kernel/dexel/stock_column.h"

namespace kerf {

DexelField::DexelField(const StockShape& stock, double pitch_mm, RayAxis axis)
    : stock_(stock),
      grid_(make_grid(stock, pitch_mm, axis)),
      tiles_(grid_.tiles_x(), grid_.tiles_y()) {}

DexelTile& DexelField::edit(TileIndex tile) {
  std::shared_ptr<DexelTile>& slot = tiles_.slot(tile, era_);
  if (!slot) {
    slot = std::make_shared<DexelTile>();
    fill_from_stock(stock_, grid_, tile, *slot);
  } else if (slot->era != era_) {
    slot = std::make_shared<DexelTile>(*slot);
  }
  slot->era = era_;
  return *slot;
}

DexelSnapshot DexelField::snapshot() {
  ++era_;
  return {grid_, stock_, tiles_};
}

double DexelField::stock_volume_mm3() const {
  return stock_quanta(stock_, grid_) * grid_.quantum_mm3();
}

std::size_t DexelField::memory_bytes() const {
  std::size_t bytes = sizeof *this + tiles_.bytes();
  tiles_.for_each([&](TileIndex, const DexelTile& tile) { bytes += tile.bytes(); });
  return bytes;
}

}  // namespace kerf
