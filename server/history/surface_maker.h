// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/sweep/tool_motion.h"
#include "server/history/stock_cell.h"
#include "server/history/stroke_table.h"

namespace kerf {

/// The motion that made a point of the surface.
struct SurfaceMaker {
  std::uint64_t record = 0;
  Stroke stroke;
  ToolMotion motion;
};

}  // namespace kerf
