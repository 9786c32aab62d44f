// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kernel/dexel/dexel_grid.h"
#include "kernel/piece/bounds.h"
#include "kernel/sculpture_command.h"
#include "kernel/sculpture_result.h"
#include "kernel/sweep/tool_motion.h"

namespace kerf {

/// Returns a box around everything that the cutting part of a tool passes in a motion.
Bounds reach_of(const Tool& tool, const ToolMotion& motion);
Bounds reach_of(const Tool& tool, const MoveTool& motion);

/// Returns whether the cutting part of a tool may enter a box of world coordinates in a motion.
/// Compares the box's distance from the path of the axis, at the heights that can meet it, with the
/// radius there. This is tighter than the box of reach_of, whose corners no round tool enters.
bool may_meet(const Tool& tool, const ToolMotion& motion, const Bounds& box);

/// Returns a box around everything that shank and holder pass. The tool must have one of them.
Bounds non_cutting_reach(const Tool& tool, const ToolMotion& motion);

/// Replaces `tiles` by those that a motion may change, over the fields with these grids, sorted and
/// without duplicates. They depend on the motion and the grids alone, not on the remaining stock. A
/// long motion is divided, so that a diagonal does not list all tiles of its bounding box.
/// `tolerance_mm` is that of the block.
void find_reach(const Tool& tool, const ToolMotion& motion, std::span<const DexelGrid> grids,
                double tolerance_mm, std::vector<FieldTile>& tiles);
void find_reach(const Tool& tool, const MoveTool& motion, std::span<const DexelGrid> grids,
                double tolerance_mm, std::vector<FieldTile>& tiles);

}  // namespace kerf
