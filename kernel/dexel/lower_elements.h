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

/// The lower part of a tile's split columns: the elements below the topmost one (Dexel), or the
/// normal codes of their ends (EndCodes). A raster of grooves leaves dozens of elements in a ray
/// across it, so reading or replacing a column is O(its elements) (amortized, because the pool
/// doubles), and copying the tile copies three arrays. Each split column owns a block of the pool
/// whose size is a power of two. Freed blocks are kept in one list per size. A tile without split
/// columns allocates nothing.
template <class Element>
class LowerElements {
 public:
  LowerElements() { free_.fill(kNone); }

  /// Returns a column's lower elements, from the bottom up. Valid until the next assign.
  std::span<const Element> of(int column) const {
    if (run_of_.empty() || run_of_[std::size_t(column)] == kNoRun) return {};
    const Run& run = runs_[run_of_[std::size_t(column)]];
    return {&pool_[run.first], run.count};
  }
  /// Returns a column's lower elements for editing in place. The column must have some.
  std::span<Element> edit(int column) {
    const Run& run = runs_[run_of_[std::size_t(column)]];
    return {&pool_[run.first], run.count};
  }
  /// Replaces a column's lower elements. An empty span frees the column's block. `elements` must
  /// not point into this pool.
  void assign(int column, std::span<const Element> elements);
  /// Returns the bytes of heap memory.
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
  /// Per size class, the first free block, whose first word is the number of the next.
  std::array<std::uint32_t, 32> free_;
};

extern template class LowerElements<Dexel>;
extern template class LowerElements<EndCodes>;

}  // namespace kerf
