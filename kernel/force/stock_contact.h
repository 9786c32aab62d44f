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

/// Contact of shank and holder with the stock.
struct StockContact {
  double depth_mm =
      0;          ///< depth of the deepest solid point in any non-cutting piece; 0: no contact
  Wrench wrench;  ///< F_collision and τ_collision (Eqs. 25, 26), N and N·mm about the pivot
};

/// Computes the wrench of the stock on the non-cutting pieces of a tool at a pose. Each piece that
/// contains solid points is pushed out by contact_stiffness x depth, along the mean of the piece's
/// normals over the overlap, applied at the overlap's centroid; torque about the tool's axis is
/// removed. The depth is that of the deepest solid point, less `allowance_mm`; a field resolves it
/// to the pitch across its rays and exactly along them. O(1) for pieces outside the block.
StockContact stock_contact(const Tool& tool, const ToolPose& pose,
                           std::span<const DexelField> fields, const ForceSettings& settings,
                           double allowance_mm);

/// Appends one contact plane for each of `pieces` that contains solid points. For a tool's
/// non-cutting pieces, wrench_of the planes equals stock_contact. Cutting pieces may be passed too,
/// for a tool that is not cutting.
void stock_planes(std::span<const ToolPiece> pieces, const ToolPose& pose,
                  std::span<const DexelField> fields, const ForceSettings& settings,
                  double allowance_mm, std::vector<ContactPlane>& out);

/// Returns the greatest depth of any non-cutting piece along a motion, including its end. Evaluated
/// at poses at most half the thinnest non-cutting piece's radius apart, but at no more than 256, so
/// that a long motion does not pass through stock unnoticed. Uses the stock's present state, after
/// the motion's cut.
double deepest_stock_contact(const Tool& tool, const ToolMotion& motion,
                             std::span<const DexelField> fields, double allowance_mm);

}  // namespace kerf
