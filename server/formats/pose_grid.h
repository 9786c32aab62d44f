// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/tool/tool_pose.h"

namespace kerf {

/// Step of tip coordinates on the pose grid, mm: six decimals.
inline constexpr double kTipGridMm = 1e-6;
/// Step of axis components on the pose grid: nine decimals.
inline constexpr double kAxisGrid = 1e-9;
/// An axis on the grid is not normalized if its length differs from 1 by at most this. Rounding to
/// the grid changes the length by less than 1e-9, so admission is idempotent. A larger value would
/// admit axes that were never normalized.
inline constexpr double kAxisLengthTolerance = 1e-8;

/// Rounds a pose to the grid of all poses of programs and agents: the tip to multiples of
/// kTipGridMm, the axis, normalized first, to multiples of kAxisGrid. Each number is the double
/// nearest to a decimal of at most six or nine digits, so its decimal text reads back to the same
/// bits and carving an exported program again gives the same state hash. A pose on the grid is
/// returned bit-identical. `pose` must be finite and its axis not zero.
ToolPose admit_pose(const ToolPose& pose);

}  // namespace kerf
