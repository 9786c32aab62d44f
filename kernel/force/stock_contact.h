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
  /// Depth of the deepest solid point in any non-cutting part, or 0 without contact.
  double depth_mm = 0;
  Wrench wrench;  ///< F_collision and τ_collision (Eqs. 25, 26), N and N·mm about the pivot
};

/// Computes the wrench of the stock on the non-cutting part of a tool at a pose, as one body,
/// however its outline is divided. Each convex part that contains solid points is pushed out by
/// contact_stiffness x depth, along the mean of the part's normals over the overlap, applied at the
/// overlap's centroid. Parts that are pushed in one direction share the push of the deepest
/// (BodyContact). Torque about the tool's axis is removed. The depth is that of the deepest solid
/// point, minus `allowance_mm`. A field resolves it to the pitch across its rays and exactly along
/// them. O(1) for parts outside the block.
StockContact stock_contact(const Tool& tool, const ToolPose& pose,
                           std::span<const DexelField> fields, const ForceSettings& settings,
                           double allowance_mm);

/// Appends one contact plane for each of `parts` that contains solid points, at most
/// BodyContact::kPlanesMax. For a tool's non-cutting parts, wrench_of the planes equals
/// stock_contact. For a tool that is not cutting, the parts of the whole tool may be passed.
void stock_planes(std::span<const ConvexPart> parts, const ToolPose& pose,
                  std::span<const DexelField> fields, const ForceSettings& settings,
                  double allowance_mm, std::vector<ContactPlane>& out);

/// Returns the greatest depth of any non-cutting part along a motion, including its end. It is
/// evaluated at poses at most half the thinnest non-cutting part's radius apart, but at no more
/// than 256, so that a long motion does not pass through stock unnoticed. Uses the stock's present
/// state, after the motion's cut.
double deepest_stock_contact(const Tool& tool, const ToolMotion& motion,
                             std::span<const DexelField> fields, double allowance_mm);

}  // namespace kerf
