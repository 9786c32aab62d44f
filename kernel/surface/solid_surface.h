// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "kernel/surface/face_cover.h"
#include "kernel/surface/face_fan.h"
#include "kernel/surface/tile_mesh.h"

namespace kerf {

/// The whole surface of a solid in pieces, for export. Its cost is proportional to the carved area:
/// where the stock's flat faces are untouched, squares that grow with the distance from cuts
/// replace the tiles' triangles (face_cover.h). Everything else comes from mesh_tile, so a block
/// without such faces gives the tiles' meshes, row by row. The union of the pieces is closed,
/// 2-manifold, consistently oriented, and has no degenerate triangle. Equal snapshots give equal
/// bytes.
class SolidSurface {
 public:
  explicit SolidSurface(SolidSnapshot solid);
  SolidSurface(const SolidSurface&) = delete;
  SolidSurface& operator=(const SolidSurface&) = delete;

  /// Replaces `piece` by the next one, which may have no triangles: a tile, or up to some thousand
  /// triangles of squares that begin in one row of tiles. Returns false at the end.
  bool next(TileMesh& piece);
  /// Replaces `piece` by the next one, whose mesh finish() may have to compute. Returns false at
  /// the end.
  bool begin(TileMesh& piece);
  /// Completes a piece that begin() has returned. Thread-safe, so that several threads can mesh.
  void finish(TileMesh& piece) const;
  /// Returns the fraction of the pieces that have been read, 0 to 1.
  double share() const;

  /// Returns the number of tiles that are meshed column by column.
  std::size_t tiles() const { return tiles_.size(); }
  /// Returns the number of squares of untouched faces.
  std::size_t squares() const { return squares_.size(); }

 private:
  struct Square {
    std::int32_t row;  ///< row of tiles in which it begins
    StockFace face;
    FaceNode node;
  };
  void plan();

  SolidSnapshot solid_;
  FaceCover cover_;
  FaceFan fan_;
  std::vector<Square> squares_;   ///< by row
  std::vector<TileIndex> tiles_;  ///< row by row
  std::size_t next_square_ = 0, next_tile_ = 0;
};

}  // namespace kerf
