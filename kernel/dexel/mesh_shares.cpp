// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/mesh_shares.h"

#include <algorithm>
#include <cmath>

namespace kerf {
namespace {

/// Difference of the lengths of two neighboring columns, in pitches, that indicates a wall between
/// them.
constexpr double kWallPitches = 2;
/// Greatest share of a column. That of a ray that only grazes the mesh would be unbounded.
constexpr double kShareMax = 4;

/// Shares that differ by less, by the rounding of depths and floats, are equal.
constexpr double kSame = 1.0 / (1 << 20);

constexpr std::array<std::array<std::int32_t, 2>, 4> kNeighbors{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};

/// A convex polygon: a triangle, clipped at up to four lines.
struct Polygon {
  std::array<Vec3, 8> corner;
  std::size_t count = 0;

  /// Clips the polygon to one side of a line across x or y: above it, or below it for side -1.
  void clip(bool along_x, double line, double side) {
    const Polygon all = *this;
    count = 0;
    const auto above = [&](Vec3 v) { return ((along_x ? v.x : v.y) - line) * side; };
    for (std::size_t n = 0; n < all.count; ++n) {
      const Vec3 a = all.corner[n], b = all.corner[(n + 1) % all.count];
      const double from = above(a), to = above(b);
      if (from >= 0) corner[count++] = a;
      if ((from >= 0) != (to >= 0)) corner[count++] = a + (b - a) * (from / (from - to));
    }
  }
  /// Returns the volume between the polygon and z = 0, negative if it is seen from below.
  double volume() const {
    double sum = 0;
    for (std::size_t n = 2; n < count; ++n) {
      const Vec3 &a = corner[0], &b = corner[n - 1], &c = corner[n];
      sum += ((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y)) * (a.z + b.z + c.z) / 6;
    }
    return sum;
  }
};

}  // namespace

MeshShares::MeshShares(const DexelGrid& grid, const RowsOfMesh& rows)
    : grid_(grid), rows_(rows), near_(rows.length.size()), volume_(rows.length.size()) {
  for (std::int32_t row = 0; row < RowsOfMesh::kRows; ++row) {
    for (std::int32_t i = 0; i < grid.columns_x; ++i) near_[place(i, row)] = is_near_wall(i, row);
  }
}

bool MeshShares::is_inside(std::int32_t i, std::int32_t row) const {
  const std::int32_t j = rows_.first_row + row;
  return i >= 0 && i < grid_.columns_x && row >= 0 && row < RowsOfMesh::kRows && j >= 0 &&
         j < grid_.columns_y;
}

bool MeshShares::is_near_wall(std::int32_t i, std::int32_t row) const {
  if (!is_inside(i, row)) return false;
  const double here = rows_.length[place(i, row)];
  const double most = kWallPitches * grid_.pitch_mm / grid_.z_quantum_mm;
  return std::ranges::any_of(kNeighbors, [&](const auto& to) {
    // A wall next to the side of the block may lean.
    if (!is_inside(i + to[0], row + to[1])) return here > 0;
    const double there = rows_.length[place(i + to[0], row + to[1])];
    return std::abs(there - here) > most || (there > 0) != (here > 0);
  });
}

void MeshShares::add(const std::array<Vec3, 3>& corners) {
  Polygon triangle;
  for (const Vec3& c : corners) {
    const Vec3 from = c - grid_.origin_mm;
    triangle.corner[triangle.count++] = {from.x / grid_.pitch_mm, from.y / grid_.pitch_mm, from.z};
  }
  const auto [a, b, c] = std::tuple(triangle.corner[0], triangle.corner[1], triangle.corner[2]);
  const auto first = [](double x, double y, double z, std::int32_t most) {
    return static_cast<std::int32_t>(std::clamp(std::min({x, y, z}), 0.0, double(most)));
  };
  const auto last = [](double x, double y, double z, std::int32_t most) {
    return static_cast<std::int32_t>(std::clamp(std::max({x, y, z}), 0.0, double(most)));
  };
  // The last column and the last row reach up to the sides of the block.
  const std::int32_t last_i = grid_.columns_x - 1, last_j = grid_.columns_y - 1;
  const std::int32_t i_end = last(a.x, b.x, c.x, last_i), j_first = first(a.y, b.y, c.y, last_j);
  const std::int32_t j_end =
      std::min(last(a.y, b.y, c.y, last_j), rows_.first_row + RowsOfMesh::kRows - 1);
  for (std::int32_t j = std::max(j_first, rows_.first_row); j <= j_end; ++j) {
    for (std::int32_t i = first(a.x, b.x, c.x, last_i); i <= i_end; ++i) {
      const std::size_t at = place(i, j - rows_.first_row);
      if (near_[at] == 0) continue;
      Polygon part = triangle;
      part.clip(true, i, 1);
      if (i < last_i) part.clip(true, i + 1, -1);
      part.clip(false, j, 1);
      if (j < last_j) part.clip(false, j + 1, -1);
      volume_[at] += part.volume();
    }
  }
}

/// Returns the neighbor that counts the volume over a column without solid: the one with the
/// largest volume, or -1.
std::int32_t MeshShares::taker(std::int32_t i, std::int32_t row) const {
  std::int32_t best = -1;
  double most = 0;
  for (std::size_t n = 0; n < kNeighbors.size(); ++n) {
    const std::int32_t x = i + kNeighbors[n][0], y = row + kNeighbors[n][1];
    if (!is_inside(x, y) || rows_.length[place(x, y)] <= most) continue;
    most = rows_.length[place(x, y)];
    best = static_cast<std::int32_t>(n);
  }
  return best;
}

double MeshShares::share(std::int32_t i, std::int32_t row) const {
  const std::size_t at = place(i, row);
  double volume = std::abs(volume_[at]);
  for (std::size_t n = 0; n < kNeighbors.size(); ++n) {
    const std::int32_t x = i + kNeighbors[n][0], y = row + kNeighbors[n][1];
    if (!is_inside(x, y) || rows_.length[place(x, y)] > 0) continue;
    // Neighbors in opposite directions: 0 and 1, 2 and 3.
    if (taker(x, y) == static_cast<std::int32_t>(n ^ 1U)) volume += std::abs(volume_[place(x, y)]);
  }
  return std::min(volume / (rows_.length[at] * grid_.z_quantum_mm), kShareMax);
}

bool MeshShares::of_tile(TileIndex tile, const ColumnShares& sides,
                         ColumnShares::OfTile& shares) const {
  bool any = false;
  for (std::int32_t c = 0; c < kTileColumns; ++c) {
    const std::int32_t i = tile.x * kTileSide + c % kTileSide, row = c / kTileSide;
    const std::int32_t in_rows = row + RowsOfMesh::kMargin;
    const bool inside = is_inside(i, in_rows);
    const std::size_t at = inside ? place(i, in_rows) : 0;
    double value = sides.of(i, tile.y * kTileSide + row);
    if (inside && near_[at] != 0 && rows_.length[at] > 0 && rows_.simple[at] != 0) {
      const double by_volume = share(i, in_rows);
      if (std::abs(by_volume - value) > kSame) {
        value = by_volume;
        any = true;
      }
    }
    shares[std::size_t(c)] = static_cast<float>(value);
  }
  return any;
}

}  // namespace kerf
