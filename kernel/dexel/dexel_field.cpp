// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/dexel_field.h"

#include <algorithm>
#include <utility>

#include "kernel/dexel/mesh_stock.h"
#include "kernel/dexel/stock_column.h"

namespace kerf {

DexelField::DexelField(const StockShape& stock, double pitch_mm, RayAxis axis, bool keep_normals)
    : stock_(stock),
      grid_(make_grid(stock, pitch_mm, axis)),
      shares_(stock_, grid_),
      keep_normals_(keep_normals),
      tiles_(grid_.tiles_x(), grid_.tiles_y()),
      untouched_(tiles_),
      stock_volume_mm3_(stock_quanta(stock_, grid_) * grid_.quantum_mm3()) {}

DexelField::DexelField(const TriangleMesh& mesh, double pitch_mm, RayAxis axis, bool keep_normals,
                       const StopAsked& stop_asked)
    : DexelField(mesh_bounds(mesh), pitch_mm, axis, keep_normals) {
  const auto store = [this](TileIndex at, std::shared_ptr<DexelTile> tile) {
    tile->era = era_;
    put(at, std::move(tile));
  };
  dexelize(mesh, grid_, keep_normals, store, &shares_, stop_asked);
  if (keep_normals) untouched_ = tiles_;
  stock_volume_mm3_ = snapshot().volume_mm3();  // from now on the tiles are shared
}

std::shared_ptr<DexelTile> DexelField::fresh(TileIndex tile) const {
  const DexelTile* stored = tiles_.find(tile);
  auto made = stored != nullptr ? std::make_shared<DexelTile>(*stored)
                                : std::make_shared_for_overwrite<DexelTile>();
  if (stored == nullptr) {
    fill_from_stock(stock_, grid_, tile, *made);
    if (keep_normals_) made->topmost_codes.resize(kTileColumns);
  }
  made->era = era_;
  return made;
}

void DexelField::put(TileIndex tile, std::shared_ptr<DexelTile> fresh) {
  tiles_.slot(tile, era_) = std::move(fresh);
}

void DexelField::put_shared(TileIndex tile, const std::shared_ptr<const DexelTile>& shared) {
  if (!shared && find(tile) == nullptr) return;
  // A field edits only tiles of its present era, which this tile is not of.
  put(tile, std::const_pointer_cast<DexelTile>(shared));
}

std::shared_ptr<DexelTile> DexelField::take(TileIndex tile) {
  if (editable(tile) == nullptr) return nullptr;
  return std::exchange(tiles_.slot(tile, era_), nullptr);
}

DexelSnapshot DexelField::snapshot() {
  ++era_;
  return {grid_, stock_, shares_, tiles_, untouched_};
}

void DexelField::restore(const DexelSnapshot& state) {
  tiles_ = state.tiles();
  // The tiles are shared with the view, including those of another field, whose eras may be later.
  era_ = std::max(era_, tiles_.era()) + 1;
}

std::size_t DexelField::memory_bytes() const {
  std::size_t bytes = sizeof *this + tiles_.bytes() + shares_.bytes();
  tiles_.for_each([&](TileIndex, const DexelTile& tile) { bytes += tile.bytes(); });
  untouched_.for_each([&](TileIndex at, const DexelTile& tile) {
    if (tiles_.find(at) != &tile) bytes += tile.bytes();
  });
  return bytes;
}

}  // namespace kerf
