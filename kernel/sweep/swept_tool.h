// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <variant>
#include <vector>

#include "kernel/sweep/ball_sweep.h"
#include "kernel/sweep/frustum_translation.h"
#include "kernel/sweep/tool_motion.h"
#include "kernel/sweep/turning_sweep.h"
#include "kernel/tool/tool.h"

namespace kerf {

using SweptPiece = std::variant<BallSweep, FrustumTranslation, TurningSweep>;

/// The tool during one part of its motion: the union of its swept pieces, less those that stay
/// outside the block. Where two pieces leave less than `join_mm` of a ray between them it is
/// removed as well: rounding where nothing turns, else the tolerance, within which each piece may
/// fall short of the seam.
struct SweptTool {
  std::vector<SweptPiece> pieces;
  double join_mm = kEdgeEpsilonMm;
};

/// One part of a motion: what is removed, and the motion that the force opposes.
struct SubMotion {
  SweptTool swept;
  ToolMotion motion;
  double share;        ///< of the whole motion's duration
  std::int64_t count;  ///< sub-motions that it counts for: the most that a piece is divided into
};

/// Sub-motions that one motion may need before it is rejected.
inline constexpr std::int64_t kSubMotionsMax = 1 << 20;

/// How a motion is swept.
struct SweepSettings {
  MotionModel model;
  double tolerance_mm;  ///< greatest end-point error against the true motion, off the surface
  SweepBounds block;    ///< where rays are: parts of the tool that stay outside need no sweep
  bool start_is_cut =
      false;  ///< the tool at the first pose has been removed from the block already
};

/// Sub-motions that a motion needs (kernel/README.md, "The tight model", "The paper's model"). May
/// exceed kSubMotionsMax: then the motion is rejected.
std::int64_t count_sub_motions(const Tool& tool, const ToolMotion& motion,
                               const SweepSettings& settings);

/// Calls `visit` for every part of the sweep of a tool along a motion, in order; their union is the
/// swept volume (paper Eqs. 9–12).
void sweep_tool(const Tool& tool, const ToolMotion& motion, const SweepSettings& settings,
                const std::function<void(const SubMotion&)>& visit);

}  // namespace kerf
