#include "kernel/dexel/dexel_snapshot.h"

#include <bit>

#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/stock_column.h"
#include "kernel/math/hash.h"

namespace kerf {

DexelSnapshot::DexelSnapshot(DexelGrid grid, StockShape stock,
                             std::vector<std::shared_ptr<const DexelTile>> tiles)
    : grid_(grid), stock_(stock), tiles_(std::move(tiles)) {}

bool DexelSnapshot::touched(TileIndex tile) const {
  return tiles_[std::size_t(tile.y) * std::size_t(grid_.tiles_x()) + std::size_t(tile.x)] !=
         nullptr;
}

std::span<const Dexel> DexelSnapshot::column(std::int32_t i, std::int32_t j,
                                             std::vector<Dexel>& scratch) const {
  scratch.clear();
  if (i < 0 || j < 0 || i >= grid_.columns_x || j >= grid_.columns_y) return scratch;
  const auto index =
      std::size_t(j / kTileSide) * std::size_t(grid_.tiles_x()) + std::size_t(i / kTileSide);
  if (const DexelTile* tile = tiles_[index].get()) {
    tile->read((j % kTileSide) * kTileSide + i % kTileSide, scratch);
  } else if (const Dexel whole = stock_column(stock_, grid_, i, j); whole.bottom < whole.top) {
    scratch.push_back(whole);
  }
  return scratch;
}

double DexelSnapshot::volume_mm3() const {
  std::int64_t quanta = 0;
  std::vector<Dexel> scratch;
  for (std::int32_t j = 0; j < grid_.columns_y; ++j) {
    for (std::int32_t i = 0; i < grid_.columns_x; ++i) {
      for (const Dexel& d : column(i, j, scratch)) quanta += d.top - d.bottom;
    }
  }
  return static_cast<double>(quanta) * grid_.z_quantum_mm * grid_.pitch_mm * grid_.pitch_mm;
}

std::uint64_t DexelSnapshot::hash() const {
  Hash hash;
  hash.add(std::bit_cast<std::uint64_t>(grid_.pitch_mm));
  hash.add(std::bit_cast<std::uint64_t>(grid_.z_quantum_mm));
  hash.add(std::bit_cast<std::uint64_t>(grid_.origin_mm.x));
  hash.add(std::bit_cast<std::uint64_t>(grid_.origin_mm.y));
  hash.add(std::bit_cast<std::uint64_t>(grid_.origin_mm.z));
  std::vector<Dexel> scratch;
  for (std::int32_t j = 0; j < grid_.columns_y; ++j) {
    for (std::int32_t i = 0; i < grid_.columns_x; ++i) {
      const std::span<const Dexel> dexels = column(i, j, scratch);
      hash.add(dexels.size());
      for (const Dexel& d : dexels) {
        hash.add(std::uint64_t(static_cast<std::uint32_t>(d.bottom)) << 32 |
                 static_cast<std::uint32_t>(d.top));
      }
    }
  }
  return hash.value();
}

}  // namespace kerf
