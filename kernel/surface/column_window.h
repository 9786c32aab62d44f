#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"

namespace kerf {

/// One solid element of a column, seen on the lattice of samples that the mesh is made on: the
/// samples [first, end) are solid, and the exact ends lie at most one sample step outside of them.
struct SolidRun {
  std::int32_t first = 0, end = 0;   ///< samples; first < end
  std::int32_t bottom = 0, top = 0;  ///< quanta
};

enum class DexelEnd : std::uint8_t { kBottom, kTop };

/// A copy of the columns of one tile and a margin around it, sampled at heights that are one pitch
/// apart. Sample k stands at level(k) quanta; level(0) is the block's lowest plane. A sample is
/// solid where bottom <= level < top, so an element that contains no sample disappears, and so does
/// a gap. Columns outside the grid are empty.
class ColumnWindow {
 public:
  ColumnWindow(const DexelSnapshot& snapshot, std::int32_t first_x, std::int32_t first_y,
               std::int32_t side);

  const DexelGrid& grid() const { return grid_; }
  bool in_grid(std::int32_t i, std::int32_t j) const {
    return i >= 0 && j >= 0 && i < grid_.columns_x && j < grid_.columns_y;
  }
  /// The runs of column (i, j), from the bottom up; (i, j) must lie in the window.
  std::span<const SolidRun> runs(std::int32_t i, std::int32_t j) const {
    const std::size_t n = number(i, j);
    return {runs_.data() + start_[n], runs_.data() + start_[n + 1]};
  }
  /// Position of the column's first run among all runs of the window.
  std::size_t run_number(std::int32_t i, std::int32_t j) const { return start_[number(i, j)]; }
  std::size_t run_count() const { return runs_.size(); }
  bool solid(std::int32_t i, std::int32_t j, std::int32_t sample) const;
  /// The end of that kind which is nearest to a height (quanta); nothing in an empty column.
  std::optional<std::int32_t> nearest_end(std::int32_t i, std::int32_t j, DexelEnd kind,
                                          std::int32_t height) const;

  std::int32_t level(std::int32_t sample) const {
    return static_cast<std::int32_t>(std::floor(sample * quanta_per_step_ + 0.5));
  }
  double quanta_per_step() const { return quanta_per_step_; }

 private:
  std::size_t number(std::int32_t i, std::int32_t j) const {
    return static_cast<std::size_t>(j - first_y_) * static_cast<std::size_t>(side_) +
           static_cast<std::size_t>(i - first_x_);
  }
  void append_column(std::span<const Dexel> dexels);
  std::int32_t first_sample_at_or_above(std::int32_t height) const;

  DexelGrid grid_;
  double quanta_per_step_;
  std::int32_t first_x_, first_y_, side_;
  std::vector<SolidRun> runs_;
  std::vector<std::uint32_t> start_;
};

}  // namespace kerf
