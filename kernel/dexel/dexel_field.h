// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "kernel/dexel/column_shares.h"
#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/stop_asked.h"
#include "kernel/dexel/triangle_mesh.h"

namespace kerf {

/// The stock as a grid of columns along one axis (paper section 2.1, Fig. 2a), in tiles that are
/// allocated when they are first cut. Snapshots share tiles with the field copy-on-write: taking
/// one copies no column, and readers on other threads never wait.
class DexelField {
 public:
  /// Builds an untouched field. Stock and pitch must be valid (Sculpture::create checks them). With
  /// `keep_normals`, touched tiles store the normals of their ends (LazyNormals).
  DexelField(const StockShape& stock, double pitch_mm, RayAxis axis = RayAxis::kZ,
             bool keep_normals = false);
  /// Builds the solid bounded by a mesh (mesh_stock.h). The stock shape is the mesh's bounding box.
  /// Every tile that the solid does not fill is stored, as if a tool had cut it. The field lacks
  /// some of them if a stop was asked meanwhile.
  DexelField(const TriangleMesh& mesh, double pitch_mm, RayAxis axis, bool keep_normals,
             const StopAsked& stop_asked = {});

  const DexelGrid& grid() const { return grid_; }
  const StockShape& stock() const { return stock_; }
  /// Returns each column's share of the pitch's square.
  const ColumnShares& shares() const { return shares_; }
  bool keeps_normals() const { return keep_normals_; }

  /// Returns a stored tile, or null while it is untouched. It must be in the grid.
  const DexelTile* find(TileIndex tile) const { return tiles_.find(tile); }
  /// Returns the dexels of a column (column_of).
  std::span<const Dexel> column(std::int32_t i, std::int32_t j, std::vector<Dexel>& scratch) const {
    return column_of(tiles_, stock_, grid_, i, j, scratch);
  }
  /// Returns a stored tile to be shared, or null while it is untouched. The field may still edit
  /// it.
  std::shared_ptr<const DexelTile> share(TileIndex tile) const { return tiles_.share(tile); }
  /// Returns a tile that may be edited in place, or null while it is untouched or shared with a
  /// snapshot. Different tiles may be requested and edited on several threads at once.
  DexelTile* editable(TileIndex tile) { return tiles_.own(tile, era_); }
  /// Returns a new tile to edit and then `put`, for a tile for which `editable` returned null. It
  /// is made from the stock's shape if the tile is untouched, and is otherwise a copy. Thread-safe
  /// while no thread calls `put`.
  std::shared_ptr<DexelTile> fresh(TileIndex tile) const;
  /// Replaces the present tile.
  void put(TileIndex tile, std::shared_ptr<DexelTile> fresh);
  /// Stores a shared tile, of era 0 or of a copy of this field. Null makes the tile untouched.
  void put_shared(TileIndex tile, const std::shared_ptr<const DexelTile>& shared);
  /// Removes a tile from the field and returns it, if it was stored after the last snapshot. The
  /// field is untouched there from then on. Otherwise returns null, and nothing changes.
  std::shared_ptr<DexelTile> take(TileIndex tile);
  /// Returns an immutable view of the present state.
  DexelSnapshot snapshot();
  /// Returns whether a view belongs to a field with the same rays and stock.
  bool fits(const DexelSnapshot& state) const {
    return state.grid() == grid_ && state.stock() == stock_;
  }
  /// Replaces the tiles by those of a view that fits, of this field or of another one.
  void restore(const DexelSnapshot& state);
  /// Returns the volume of the stock's columns before the first cut, mm^3.
  double stock_volume_mm3() const { return stock_volume_mm3_; }
  /// Returns the bytes of the field, including tiles shared with snapshots. O(touched tiles).
  std::size_t memory_bytes() const;

 private:
  StockShape stock_;
  DexelGrid grid_;
  ColumnShares shares_;
  bool keep_normals_;
  TileDirectory tiles_;
  /// The tiles before the first cut, if the block began as a mesh and keeps normals. Otherwise
  /// empty, because the stock's shape describes them.
  TileDirectory untouched_;
  double stock_volume_mm3_ = 0;
  std::uint64_t era_ = 1;  ///< incremented by each snapshot; nodes of earlier eras are shared
};

}  // namespace kerf
