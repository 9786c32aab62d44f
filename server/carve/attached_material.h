// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"

namespace kerf {

/// Separates the material of a block that is connected with a part from pieces that were cut loose
/// and fall off, such as a frame around a contour. Elements of neighboring columns are connected if
/// they overlap in depth.
class AttachedMaterial {
 public:
  /// Both must have the same grid.
  AttachedMaterial(const DexelSnapshot& block, const DexelSnapshot& part);
  /// Returns whether the n-th element, from below, of column (i, j) of the block is connected with
  /// material of the part.
  bool is_attached(std::int32_t i, std::int32_t j, std::size_t n) const;
  /// Returns the volume of the loose pieces, mm^3.
  double loose_mm3() const { return loose_mm3_; }

 private:
  struct Row;
  void add_row(const DexelSnapshot& block, const DexelSnapshot& part, std::int32_t j,
               const Row& before, Row& row);
  std::uint32_t piece_of(std::uint32_t label);
  void join(std::uint32_t& label, std::uint32_t other);

  std::int32_t columns_x_;
  std::vector<std::size_t> first_;      ///< of each column: its lowest element in labels_
  std::vector<std::uint32_t> labels_;   ///< of each element; a piece may have several
  std::vector<std::uint32_t> parents_;  ///< of each label: a lower one of the same piece
  std::vector<bool> attached_;          ///< of each label
  double loose_mm3_ = 0;
};

}  // namespace kerf
