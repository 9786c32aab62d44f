// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/tool/tool_pose.h"

namespace kerf {

/// Distance of neighbouring tips on the pose grid, mm: six decimals.
inline constexpr double kTipGridMm = 1e-6;
/// Distance of neighbouring axis components on the pose grid: nine decimals.
inline constexpr double kAxisGrid = 1e-9;
/// An axis on the grid is kept as it is if its length is within this of 1. Rounding moves the
/// length by less than 1e-9, so admission is idempotent; larger, and axes that were never
/// normalised would pass.
inline constexpr double kAxisLengthTolerance = 1e-8;

/// Rounds a pose onto the grid on which programs and agents may place a tool: the tip to multiples
/// of kTipGridMm, the axis (normalised first) to multiples of kAxisGrid. Each number is the double
/// nearest to a decimal of at most six or nine places, so text with that many decimals reads back
/// to the same bits, and re-carving an exported program gives the same state hash. A pose that is
/// on the grid stays bit-identical. `pose` is finite and its axis not zero.
ToolPose admit_pose(const ToolPose& pose);

}  // namespace kerf
