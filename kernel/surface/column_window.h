// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "kernel/surface/scratch.h"

namespace kerf {

/// A solid element of a column, sampled on the lattice of the mesh. Samples [first, end) are solid,
/// and the exact ends are at most one sample step outside of them.
struct SolidRun {
  std::int32_t first = 0, end = 0;                   ///< samples; first < end
  std::int32_t bottom = 0, top = 0;                  ///< quanta
  Vec3 bottom_normal, top_normal;                    ///< of the surface at the ends: unit, outward
  bool bottom_original = true, top_original = true;  ///< whether it is the untouched stock's
};

/// A copy of the columns along Z of one tile and a margin around it, sampled one pitch apart.
/// Sample k is at height level(k), in quanta. With three fields, samples are at the points where
/// rays of all three meet. With one field, or in a block too low for such a sample, level(0) is the
/// block's lowest plane, so nothing that touches that plane is lost. A sample is solid where bottom
/// <= level < top. An element that contains no sample is lost, and so is a gap that contains none.
/// Columns outside the grid are empty.
class ColumnWindow {
 public:
  ColumnWindow(const SolidSnapshot& solid, std::int32_t first_x, std::int32_t first_y,
               std::int32_t side);

  const DexelGrid& grid() const { return grid_; }
  bool in_grid(std::int32_t i, std::int32_t j) const {
    return i >= 0 && j >= 0 && i < grid_.columns_x && j < grid_.columns_y;
  }
  /// Returns the runs of column (i, j), from the bottom up. (i, j) must be in the window.
  std::span<const SolidRun> runs(std::int32_t i, std::int32_t j) const {
    const std::size_t n = number(i, j);
    return {runs_->data() + start_[n], runs_->data() + start_[n + 1]};
  }
  /// Returns the number of samples within the block: 0 to samples() - 1.
  std::int32_t samples() const { return first_sample_at_or_above(grid_.height_quanta); }
  /// Returns whether a sample is solid.
  bool solid(std::int32_t i, std::int32_t j, std::int32_t sample) const;
  /// Returns the height of a sample, in quanta. Samples outside the block may be higher than any
  /// depth: in a block lower than half a pitch, one step exceeds 2^31 quanta.
  std::int64_t level(std::int32_t sample) const {
    return static_cast<std::int64_t>(std::floor((sample + level_zero_) * quanta_per_step_ + 0.5));
  }
  /// Converts a height in quanta to sample steps: steps(level(k)) is k, to rounding.
  double steps(std::int32_t height) const { return height / quanta_per_step_ - level_zero_; }
  /// Returns the height of sample 0 above the block's lowest plane, in steps.
  double level_zero() const { return level_zero_; }

 private:
  std::size_t number(std::int32_t i, std::int32_t j) const {
    return static_cast<std::size_t>(j - first_y_) * static_cast<std::size_t>(side_) +
           static_cast<std::size_t>(i - first_x_);
  }
  static Vec3 end_normal(const DexelSnapshot& field, std::int32_t i, std::int32_t j,
                         std::int32_t depth, bool top, NormalCode code);
  void append_column(const DexelSnapshot& field, std::int32_t i, std::int32_t j);
  void append_run(const SolidRun& run);
  std::int32_t first_sample_at_or_above(std::int32_t height) const;

  DexelGrid grid_;
  double quanta_per_step_, level_zero_;
  std::int32_t first_x_, first_y_, side_;
  Scratch<SolidRun> runs_;
  std::vector<std::uint32_t> start_;
};

}  // namespace kerf
