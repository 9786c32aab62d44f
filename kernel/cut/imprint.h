// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_grid.h"
#include "kernel/sweep/swept_tool.h"

namespace kerf {

/// Removes the imprint of a tool from the removed elements: their parts inside the tool at the pose
/// where its motion began. `standing` is the sweep of the tool at rest at that pose, in the frame
/// of the field on `grid`; its ends are rounded as those of a cut. `removed` keeps the parts that
/// the motion itself removed; an element that the imprint divides becomes two. Returns the total
/// length of the imprint, in quanta. The stock does not change.
std::int64_t take_imprint(const SweptTool& standing, const DexelGrid& grid, RemovedPart& removed);

}  // namespace kerf
