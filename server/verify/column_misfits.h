// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "server/verify/part_model.h"

namespace kerf {

/// The difference of one column of a block from a part, on one side of its surface.
struct ColumnMisfit {
  std::int32_t i = 0, j = 0;
  double depth_mm = 0;   ///< greatest distance from the surface of the part, > the tolerance
  double z_mm = 0;       ///< where
  double length_mm = 0;  ///< of the differing material
};

/// Measures columns along Z of a block against a part. Every differing interval is searched, so
/// walls that were removed entirely are found. For one thread.
class ColumnMisfits {
 public:
  /// `part` must outlive this object and be of the block's grid.
  ColumnMisfits(const PartModel& part, double tolerance_mm)
      : part_(part), tolerance_mm_(tolerance_mm) {}

  /// Returns the material that the column lost between `before` and `after` deeper than the
  /// tolerance below the surface of the part, if any.
  std::optional<ColumnMisfit> gouge(const DexelSnapshot& before, const DexelSnapshot& after,
                                    std::int32_t i, std::int32_t j);
  /// Returns the part of `material` farther than the tolerance outside the part, whose material()
  /// must not be null.
  std::optional<ColumnMisfit> rest(std::span<const Dexel> material, std::int32_t i, std::int32_t j);
  /// Distances from the part computed so far. One takes about a microsecond.
  std::size_t distances() const { return distances_; }

 private:
  std::optional<ColumnMisfit> walk(double side, std::int32_t i, std::int32_t j);
  void walk(ColumnMisfit& found, const Dexel& element, double side);
  bool is_shallow(const Dexel& element) const;

  const PartModel& part_;
  double tolerance_mm_;
  std::uint32_t near_ = 0;
  std::size_t distances_ = 0;
  std::vector<Dexel> whole_, left_, removed_, of_part_, parts_;
};

}  // namespace kerf
