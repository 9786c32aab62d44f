// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/math/ray_axis.h"
#include "kernel/sweep/tool_motion.h"
#include "server/history/stroke_table.h"

namespace kerf {

/// A quantum of a column of a field: from `depth` to depth + 1.
struct StockCell {
  RayAxis axis = RayAxis::kZ;
  std::int32_t i = 0, j = 0;  ///< column, within the grid
  std::int32_t depth = 0;
};

/// The motion that made a place of the surface.
struct SurfaceMaker {
  std::uint64_t record = 0;
  Stroke stroke;
  ToolMotion motion;
};

}  // namespace kerf
