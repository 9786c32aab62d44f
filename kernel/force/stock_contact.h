// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kernel/dexel/dexel_field.h"
#include "kernel/force/contact_plane.h"
#include "kernel/force/force_settings.h"
#include "kernel/math/wrench.h"
#include "kernel/sweep/tool_motion.h"
#include "kernel/tool/tool.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// The shank and the holder pressed into the stock.
struct StockContact {
  double depth_mm = 0;  ///< of the deepest solid point in any non-cutting piece; 0: no contact
  Wrench wrench;        ///< F_collision and τ_collision (Eqs. 25–26), N and N·mm about the pivot
};

/// What the stock does to the non-cutting pieces of a tool at a pose: each piece that holds solid
/// points is pushed out by contact_stiffness x depth, along the mean of the piece's normals over
/// the overlap, at the middle of the overlap; no torque about the axis itself. The depth is how far
/// the deepest solid point is inside, beyond `allowance_mm`; a field sees it to its pitch across
/// the rays and exactly along them. Without non-cutting pieces, and while they are beside the
/// block, it costs a few comparisons.
StockContact stock_contact(const Tool& tool, const ToolPose& pose,
                           std::span<const DexelField> fields, const ForceSettings& settings,
                           double allowance_mm);

/// Appends one plane for each of `pieces` that holds solid points; wrench_of those of a tool's
/// non-cutting pieces is what stock_contact gives. A tool that does not cut is touched all over:
/// its cutting pieces may be given too.
void stock_planes(std::span<const ToolPiece> pieces, const ToolPose& pose,
                  std::span<const DexelField> fields, const ForceSettings& settings,
                  double allowance_mm, std::vector<ContactPlane>& out);

/// The greatest depth at poses along a motion, its end included, at most half the thinnest
/// non-cutting piece's radius apart (but no more than 256): a long motion may pass through stock
/// that it does not end in. The stock is taken as it is now, after the motion's cut.
double deepest_stock_contact(const Tool& tool, const ToolMotion& motion,
                             std::span<const DexelField> fields, double allowance_mm);

}  // namespace kerf
