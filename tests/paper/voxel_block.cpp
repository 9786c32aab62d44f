// SPDX-License-Identifier: Apache-2.0
#include "tests/paper/voxel_block.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace kerf::paper {

double Mill::lowest_mm(Vec3 from, Vec3 to, double x, double y) const {
  const Vec3 d = to - from;
  const double level = d.x * d.x + d.y * d.y, rx = x - from.x, ry = y - from.y;
  // The position of the tip nearest to (x, y), and the distance there.
  const double near = level > 0 ? (rx * d.x + ry * d.y) / level : 0;
  const double off = rx * rx + ry * ry - near * near * level;
  const double inside = radius_mm * radius_mm - off;
  if (inside < 0) return std::numeric_limits<double>::infinity();
  double least = std::numeric_limits<double>::infinity();
  const auto take = [&](double s) {
    s = std::clamp(s, 0.0, 1.0);
    const double far = off + (s - near) * (s - near) * level;
    const double height =
        ball ? radius_mm - std::sqrt(std::max(0.0, radius_mm * radius_mm - far)) : 0;
    if (far <= radius_mm * radius_mm * (1 + 1e-12))
      least = std::min(least, from.z + s * d.z + height);
  };
  take(0);
  take(1);
  take(near);
  if (level == 0) return least;
  // On a ramp: where the end of a flat mill leaves the column, or a ball's underside is lowest.
  const double span = std::sqrt(inside / level);
  const double lowest = ball ? span * d.z / std::sqrt(level + d.z * d.z) : 0;
  for (const double s : {near - span, near + span, near - lowest}) {
    if (s > 0 && s < 1) take(s);
  }
  return least;
}

VoxelBlock::VoxelBlock(const BoxStock& stock, double edge_mm)
    : stock_(stock),
      edge_mm_(edge_mm),
      nx_(int(std::lround((stock.max_mm.x - stock.min_mm.x) / edge_mm))),
      ny_(int(std::lround((stock.max_mm.y - stock.min_mm.y) / edge_mm))),
      nz_(int(std::lround((stock.max_mm.z - stock.min_mm.z) / edge_mm))),
      per_column_(std::size_t(nz_ + 63) / 64),
      words_(std::size_t(nx_) * std::size_t(ny_) * per_column_, ~std::uint64_t{0}) {
  const int spare = int(per_column_ * 64) - nz_;
  for (std::size_t n = per_column_ - 1; n < words_.size(); n += per_column_) words_[n] >>= spare;
}

void VoxelBlock::cut(const Mill& mill, Vec3 from, Vec3 to) {
  const auto place = [&](double at, double origin, int most) {
    return std::clamp(int(std::floor((at - origin) / edge_mm_)), 0, most - 1);
  };
  const double r = mill.radius_mm;
  const int i1 = place(std::max(from.x, to.x) + r, stock_.min_mm.x, nx_);
  const int j1 = place(std::max(from.y, to.y) + r, stock_.min_mm.y, ny_);
  for (int j = place(std::min(from.y, to.y) - r, stock_.min_mm.y, ny_); j <= j1; ++j) {
    for (int i = place(std::min(from.x, to.x) - r, stock_.min_mm.x, nx_); i <= i1; ++i) {
      const double low = mill.lowest_mm(from, to, x_mm(i), y_mm(j));
      if (low >= stock_.max_mm.z) continue;
      const int k = std::clamp(int(std::ceil((low - stock_.min_mm.z) / edge_mm_ - 0.5)), 0, nz_);
      std::uint64_t* words = column(i, j);
      std::size_t n = std::size_t(k) / 64;
      if (n < per_column_) words[n] &= (std::uint64_t{1} << (k % 64)) - 1;
      for (++n; n < per_column_; ++n) words[n] = 0;
    }
  }
}

std::size_t VoxelBlock::voxels() const {
  std::size_t sum = 0;
  for (const std::uint64_t word : words_) sum += std::size_t(std::popcount(word));
  return sum;
}

double VoxelBlock::top_mm(int i, int j) const {
  const std::uint64_t* words = column(i, j);
  for (std::size_t n = per_column_; n-- > 0;) {
    if (words[n] != 0) {
      return stock_.min_mm.z + edge_mm_ * double(64 * n + std::size_t(std::bit_width(words[n])));
    }
  }
  return stock_.min_mm.z;
}

}  // namespace kerf::paper
