// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/solid_surface.h"

#include <algorithm>
#include <utility>

namespace kerf {
namespace {

/// Vertices of squares after which a piece ends.
constexpr std::size_t kPieceVertices = 8192;

/// Returns the tile whose columns have the ends, or are next to the side, of a patch.
TileIndex tile_of(StockFace face, std::int32_t u, std::int32_t v, const LatticePoint& patches) {
  switch (face.axis) {
    case 0:
      return {face.high ? patches[0] - 1 : 0, u};
    case 1:
      return {v, face.high ? patches[1] - 1 : 0};
    default:
      return {u, v};
  }
}

/// Returns whether a tile and the columns next to it are outside a cylinder, so that it has no
/// surface.
bool is_outside(const StockShape& stock, const DexelGrid& grid, TileIndex tile) {
  const auto* cylinder = std::get_if<CylinderStock>(&stock);
  if (cylinder == nullptr) return false;
  const auto nearest = [](double to, double low, double high) {
    return to - std::clamp(to, low, high);
  };
  const std::int32_t i = tile.x * kTileSide, j = tile.y * kTileSide;
  const double x = nearest(cylinder->center_x_mm, grid.x_mm(i - 1), grid.x_mm(i + kTileSide));
  const double y = nearest(cylinder->center_y_mm, grid.y_mm(j - 1), grid.y_mm(j + kTileSide));
  return x * x + y * y > cylinder->radius_mm * cylinder->radius_mm;
}

bool is_before(TileIndex a, TileIndex b) { return a.y != b.y ? a.y < b.y : a.x < b.x; }

}  // namespace

SolidSurface::SolidSurface(SolidSnapshot solid)
    : solid_(std::move(solid)), cover_(solid_), fan_(solid_, cover_) {
  plan();
}

void SolidSurface::plan() {
  const LatticePoint& patches = cover_.patches();
  const auto add_square = [&](StockFace face, const FaceNode& node) {
    const TileIndex first = tile_of(face, node.u << node.level, node.v << node.level, patches);
    squares_.push_back({first.y, face, node});
  };
  const auto add_tile = [&](StockFace face, std::int32_t u, std::int32_t v) {
    const TileIndex tile = tile_of(face, u, v, patches);
    if (!is_outside(solid_.fields.front().stock(), solid_.grid(), tile)) tiles_.push_back(tile);
  };
  cover_.for_each(add_square, add_tile);
  // A cut may be inside the block. A wall belongs to the tile of its lower column.
  solid_.fields.front().for_each_touched([&](TileIndex at, const DexelTile&) {
    for (const TileIndex tile : {at, TileIndex{at.x - 1, at.y}, TileIndex{at.x, at.y - 1}}) {
      if (solid_.grid().has(tile)) tiles_.push_back(tile);
    }
  });
  std::ranges::sort(tiles_, is_before);
  const auto tail = std::ranges::unique(tiles_);
  tiles_.erase(tail.begin(), tail.end());
  std::ranges::stable_sort(squares_, {}, &Square::row);
}

bool SolidSurface::next(TileMesh& piece) {
  if (!begin(piece)) return false;
  finish(piece);
  return true;
}

bool SolidSurface::begin(TileMesh& piece) {
  const bool tile_left = next_tile_ < tiles_.size();
  const bool square_left = next_square_ < squares_.size();
  if (!tile_left && !square_left) return false;
  if (!square_left || (tile_left && tiles_[next_tile_].y < squares_[next_square_].row)) {
    piece = {tiles_[next_tile_++], {}, {}, {}};
    return true;
  }
  const std::int32_t row = squares_[next_square_].row;
  piece = {{0, row}, {}, {}, {}};
  while (next_square_ < squares_.size() && squares_[next_square_].row == row &&
         piece.positions_mm.size() < kPieceVertices) {
    const Square& square = squares_[next_square_++];
    fan_.append(square.face, square.node, piece);
  }
  return true;
}

void SolidSurface::finish(TileMesh& piece) const {
  // Squares have vertices from the beginning.
  if (piece.positions_mm.empty()) piece = mesh_tile(solid_, piece.tile, cover_);
}

double SolidSurface::share() const {
  const std::size_t all = tiles_.size() + squares_.size();
  return all == 0 ? 1 : double(next_tile_ + next_square_) / double(all);
}

}  // namespace kerf
