// SPDX-License-Identifier: Apache-2.0
#pragma once

// Commands: every change of a Sculpture is one, and a journal is a sequence of them.

#include <cstdint>
#include <variant>

#include "kernel/tool/tool.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// Identifies a tool within one sculpture. Chosen by the caller.
using ToolId = std::uint32_t;

/// Defines a tool, or replaces the one with the same id. Pending force from cuts of a replaced tool
/// is dropped.
struct DefineTool {
  ToolId id = 0;
  Tool tool;  ///< from make_tool
};

/// Moves a tool from one pose to another and removes its swept volume from the stock. The tip moves
/// on a straight line and the axis on the great circle, both uniformly.
struct MoveTool {
  ToolId tool = 0;
  /// Poses with tips within ±kCoordinateMaxMm and axes of length 0.5 to 2, which are normalized.
  /// The axis may turn by at most kTurnMaxRad from `from` to `to`.
  ToolPose from, to;
  /// Time of the motion, >= 0. Only the force depends on it; at 0 no force is computed.
  double duration_s = 0;
  /// Whether to compute the force. A motion without it leaves no pending force either.
  bool feel = true;
};

using Command = std::variant<DefineTool, MoveTool>;

/// Greatest angle, in rad, that one motion may turn the axis by: 170 degrees. At 180 degrees the
/// great circle is undefined.
inline constexpr double kTurnMaxRad = 170 * 3.14159265358979323846 / 180;

}  // namespace kerf
