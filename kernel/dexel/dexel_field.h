// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/triangle_mesh.h"

namespace kerf {

/// The stock that is being cut: a grid of columns along one axis in lazily allocated tiles (paper
/// section 2.1, Fig. 2a). An untouched tile is not stored. What a snapshot holds is copied before
/// it is next changed, so taking a snapshot costs nothing and readers on other threads never wait.
class DexelField {
 public:
  /// Stock and pitch must have been validated (Sculpture::create does).
  /// `keep_normals`: touched tiles have room for the normals of their ends (OwedNormals).
  DexelField(const StockShape& stock, double pitch_mm, RayAxis axis = RayAxis::kZ,
             bool keep_normals = false);
  /// The solid within a mesh (mesh_stock.h), whose bounds are the stock: every tile that it does
  /// not fill is stored from the beginning, as if a tool had made it.
  DexelField(const TriangleMesh& mesh, double pitch_mm, RayAxis axis, bool keep_normals);

  const DexelGrid& grid() const { return grid_; }
  const StockShape& stock() const { return stock_; }
  bool keeps_normals() const { return keep_normals_; }

  /// The tile as stored, or null while it is untouched. It must lie in the grid.
  const DexelTile* find(TileIndex tile) const { return tiles_.find(tile); }
  /// The tile to be changed where it is; null while it is untouched or a snapshot holds it.
  /// Different tiles may be asked for, and changed, on several threads at once.
  DexelTile* editable(TileIndex tile) { return tiles_.own(tile, era_); }
  /// What is to be changed instead and then `put` in its place: made from the stock's shape if
  /// untouched, else a copy. On any thread, as long as nobody calls `put`.
  std::shared_ptr<DexelTile> fresh(TileIndex tile) const;
  void put(TileIndex tile, std::shared_ptr<DexelTile> fresh);
  DexelSnapshot snapshot();
  /// Volume of the stock in columns, mm^3, before it was first cut.
  double stock_volume_mm3() const { return stock_volume_mm3_; }
  /// Memory of the field, with what it shares with snapshots; walks the touched tiles.
  std::size_t memory_bytes() const;

 private:
  StockShape stock_;
  DexelGrid grid_;
  bool keep_normals_;
  TileDirectory tiles_;
  double stock_volume_mm3_ = 0;
  std::uint64_t era_ = 1;  ///< grows with each snapshot; what is of earlier eras is shared
};

}  // namespace kerf
