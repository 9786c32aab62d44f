// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/force/milling_sum.h"
#include "kernel/force/tool_side.h"

namespace kerf {

/// A sub-motion whose elements are summed; all in the frame of a field.
struct MillingPass {
  const MillingSettings& settings;
  const Harmonics& harmonics;
  const ToolSide& side;
  Twist twist;
  CutFrame frame;
  Vec3 zero;                             ///< unit vector across the axis, from which angles count
  double feed_per_mm = 0;                ///< feed per tooth over path
  bool weighted = false;                 ///< with three fields, weight each element by n_z²
  const ColumnShares* shares = nullptr;  ///< if set, each column counts by its share
  /// If set, counts the evaluations of the tool's surface, which determine the cost.
  std::int64_t* evaluations = nullptr;
};

/// Sums the elements that a sub-motion removed from the field on `grid`. Serial, in the order of
/// the tiles.
MillingSum sum_milling(const Removal& removal, const DexelGrid& grid, const MillingPass& pass);

}  // namespace kerf
