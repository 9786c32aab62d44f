// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "kernel/piece/tool_piece.h"
#include "kernel/sweep/column_block.h"
#include "kernel/sweep/tool_motion.h"

namespace kerf {

/// Returns the part of a piece that can reach into the block during the motion, or nothing. Parts
/// farther up the axis stay outside.
std::optional<ToolPiece> clip_to_block(const ToolPiece& piece, const ToolMotion& motion,
                                       const SweepBounds& block);

}  // namespace kerf
