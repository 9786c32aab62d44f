// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <variant>
#include <vector>

#include "kernel/sweep/arc_translation.h"
#include "kernel/sweep/ball_sweep.h"
#include "kernel/sweep/frustum_translation.h"
#include "kernel/sweep/tool_above.h"
#include "kernel/sweep/tool_motion.h"
#include "kernel/sweep/turning_sweep.h"
#include "kernel/tool/tool.h"

namespace kerf {

using SweptPiece = std::variant<BallSweep, FrustumTranslation, ArcTranslation, TurningSweep>;

/// The tool during one part of its motion: the union of its swept pieces, without those that stay
/// outside the block.
struct SweptTool {
  std::vector<SweptPiece> pieces;
  std::vector<ToolAbove> above;  ///< per piece
  /// Gaps between two pieces that are shorter than this on a ray are removed too. It covers
  /// rounding in motions without a turn, and otherwise the tolerance, by which each piece may fall
  /// short of the seam.
  double join_mm = kEdgeEpsilonMm;
};

/// One part of a motion: the swept tool, and the motion that the force opposes.
struct SubMotion {
  SweptTool swept;
  ToolMotion motion;
  double share;        ///< of the whole motion's duration
  std::int64_t count;  ///< number of sub-motions that it counts as: the most parts of any piece
};

/// Motions that need more sub-motions are rejected.
inline constexpr std::int64_t kSubMotionsMax = 1 << 20;

/// Parameters of a sweep.
struct SweepSettings {
  MotionModel model;
  double tolerance_mm;  ///< greatest end-point error against the true motion, off the surface
  SweepBounds block;    ///< box around all rays; parts of the tool that stay outside are skipped
  /// The tool at the first pose has been removed from the block already.
  bool start_is_cut = false;
};

/// Returns the number of sub-motions that a motion needs (kernel/sweep/README.md, "Number of
/// stations"). If it exceeds kSubMotionsMax, the motion must be rejected.
std::int64_t count_sub_motions(const Tool& tool, const ToolMotion& motion,
                               const SweepSettings& settings);

/// Sweeps a tool along a motion: calls `visit` for every part, in order. The union of the parts is
/// the swept volume (paper Eqs. 9–12).
void sweep_tool(const Tool& tool, const ToolMotion& motion, const SweepSettings& settings,
                const std::function<void(SubMotion&&)>& visit);

}  // namespace kerf
