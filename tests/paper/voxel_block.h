// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernel/dexel/stock_shape.h"
#include "kernel/math/vec3.h"

namespace kerf::paper {

/// An upright mill with a ball or a flat end, that moves on a straight line.
struct Mill {
  bool ball = true;
  double radius_mm = 3;
  /// Returns the lowest height that it reaches over (x, y) on its path, mm; infinity beyond it.
  double lowest_mm(Vec3 from_mm, Vec3 to_mm, double x, double y) const;
};

/// A stock as cubes in a regular lattice (Fig. 1a), one bit each, which is the least that a voxel
/// model can store. It is cut by whole words. A cube is removed if its center is.
class VoxelBlock {
 public:
  VoxelBlock(const BoxStock& stock, double edge_mm);

  void cut(const Mill& mill, Vec3 from_mm, Vec3 to_mm);

  /// Returns the number of remaining cubes.
  std::size_t voxels() const;
  std::size_t bytes() const { return words_.size() * sizeof words_[0]; }
  /// Returns the height of the highest cube's upper face in the column at (i, j), mm.
  double top_mm(int i, int j) const;
  int columns_x() const { return nx_; }
  int columns_y() const { return ny_; }
  double x_mm(int i) const { return stock_.min_mm.x + (i + 0.5) * edge_mm_; }
  double y_mm(int j) const { return stock_.min_mm.y + (j + 0.5) * edge_mm_; }

 private:
  std::uint64_t* column(int i, int j) { return &words_[std::size_t(j * nx_ + i) * per_column_]; }
  const std::uint64_t* column(int i, int j) const {
    return &words_[std::size_t(j * nx_ + i) * per_column_];
  }

  BoxStock stock_;
  double edge_mm_;
  int nx_, ny_, nz_;
  std::size_t per_column_;
  std::vector<std::uint64_t> words_;  ///< columns of bits from below, row by row
};

}  // namespace kerf::paper
