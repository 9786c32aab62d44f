// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "kernel/sweep/shadow.h"
#include "kernel/sweep/tool_motion.h"
#include "kernel/tool/tool.h"

namespace kerf {

/// Radius of a piece at a height of the tool's axis; below zero where the piece has none.
double radius_at(const ToolPiece& piece, double z_mm);

/// How fast that radius grows with the height, where it has one.
double slope_at(const ToolPiece& piece, double z_mm);

/// Heights of a piece and the radii of a truncated cone around it.
Envelope envelope_of(const ToolPiece& piece);

/// The part of a slice (not a ball) between two heights.
ToolPiece slice_of(const ToolPiece& piece, double z0_mm, double z1_mm);

/// The part of a piece that can reach into the block during the motion, or nothing: what lies
/// farther up the axis stays outside.
std::optional<ToolPiece> clip_to_block(const ToolPiece& piece, const ToolMotion& motion,
                                       const SweepBounds& block);

}  // namespace kerf
