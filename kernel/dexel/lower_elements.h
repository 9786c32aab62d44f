// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/dexel/dexel.h"
#include "kernel/dexel/normal_code.h"

namespace kerf {

/// What lies below the topmost element in those columns of a tile that have been split: their
/// elements (Dexel), or the normals of their ends (EndCodes). A raster leaves dozens of elements in
/// a ray across it, so reading or replacing a column costs what that column holds (amortised: the
/// pool doubles), and copying the tile copies three arrays. Each column has a block of the pool
/// whose size is a power of two; blocks that are given up wait in a list for their size. A tile
/// without split columns holds no array.
template <class Element>
class LowerElements {
 public:
  LowerElements() { free_.fill(kNone); }

  /// The column's elements, from the bottom up; valid until the next assign.
  std::span<const Element> of(int column) const {
    if (run_of_.empty() || run_of_[std::size_t(column)] == kNoRun) return {};
    const Run& run = runs_[run_of_[std::size_t(column)]];
    return {&pool_[run.first], run.count};
  }
  /// The same of a column that has some, to be changed where they stand.
  std::span<Element> edit(int column) {
    const Run& run = runs_[run_of_[std::size_t(column)]];
    return {&pool_[run.first], run.count};
  }
  /// Replaces them; empty forgets the column. `elements` must not lie in this pool.
  void assign(int column, std::span<const Element> elements);
  /// Memory on the heap.
  std::size_t bytes() const;

 private:
  struct Run {
    std::uint32_t first = 0, count = 0;
  };
  static constexpr std::uint16_t kNoRun = 0xffff;
  static constexpr std::uint32_t kNone = 0xffffffff;

  std::uint32_t take_block(std::size_t size_class);
  void give_block(std::uint32_t first, std::size_t size_class);
  Run& run_for(int column);

  std::vector<std::uint16_t> run_of_;  ///< per column; empty while no column is split
  std::vector<Run> runs_;
  std::vector<std::uint16_t> free_runs_;
  std::vector<Element> pool_;
  std::array<std::uint32_t, 32> free_;  ///< per size class: a free block, whose first word names
                                        ///< the next
};

extern template class LowerElements<Dexel>;
extern template class LowerElements<EndCodes>;

}  // namespace kerf
