#pragma once

#include <cstdint>
#include <functional>
#include <variant>
#include <vector>

#include "kernel/sweep/ball_sweep.h"
#include "kernel/sweep/frustum_sweep.h"
#include "kernel/sweep/tool_motion.h"
#include "kernel/tool/tool.h"

namespace kerf {

using SweptPiece = std::variant<BallSweep, FrustumSweep>;

/// One piece of the tool during one part of the motion: what is removed, and the motion that the
/// force opposes.
struct SubMotion {
  SweptPiece swept;
  ToolMotion motion;
  double share;  ///< of the whole motion's duration
};

/// Parts that one motion may need before it is refused.
inline constexpr std::int64_t kSubMotionsMax = 1 << 20;

/// The heights between which a block lies (mm): parts of the tool that stay above need no sweep.
struct ZRange {
  double min_mm, max_mm;
};

/// In how many parts each piece's motion must be taken so that no end point errs by more than
/// `tolerance_mm` against the true motion; the bounds are derived in kernel/README.md ("The tight
/// model", "The paper's model"). Zero for a piece that stays above the block. The sum may exceed
/// kSubMotionsMax: then the motion is refused.
std::vector<std::int64_t> sub_motion_counts(const Tool& tool, const ToolMotion& motion,
                                            MotionModel model, double tolerance_mm, ZRange block);

/// Calls `visit` for every sub-motion of the sweep of a tool along a motion; their union is the
/// swept volume (paper Eqs. 9–12). Pieces come from the tip up, the parts of each in order.
void sweep_tool(const Tool& tool, const ToolMotion& motion, MotionModel model, double tolerance_mm,
                ZRange block, const std::function<void(const SubMotion&)>& visit);

}  // namespace kerf
