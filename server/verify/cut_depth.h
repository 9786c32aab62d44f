// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/sculpture_result.h"
#include "kernel/tool/tool_pose.h"
#include "server/verify/changed_rows.h"
#include "server/verify/convex_outline.h"
#include "server/verify/moving_tool.h"
#include "server/verify/tool_profile.h"

namespace kerf {

/// Depth of a rapid that counts as a cut even if the tolerance is finer, mm: coordinates of
/// programs are rounded to micrometers, and the radii of arcs more.
inline constexpr double kRapidDepthMm = 0.02;

/// Returns the depth above which a rapid has cut into the stock, for the tolerance of the block.
constexpr double rapid_limit_mm(double tolerance_mm) {
  return std::max(tolerance_mm, kRapidDepthMm);
}

/// Measures how deep a motion has cut into the stock: the greatest distance of removed material
/// from the surface of the tool's sweep. A tool that passes over a surface that is too high by the
/// tolerance cuts no deeper than the tolerance, on a floor and on a wall alike, however much it
/// removes. Measured in the columns along Z, every half pitch. The result is at most a pitch too
/// small, because a sample lies within 0.75 pitches of the deepest point, and the deepest sample is
/// found to 0.1 pitches; in walls thinner than a pitch there may be no such sample. The work is
/// done in portions.
class CutDepth {
 public:
  /// A motion of a tool. `cut` are the tiles that lost material (MotionResult::cut_tiles). Depths
  /// of `ignored_mm` or less may be reported as 0. With `within`, which must outlive this, only
  /// columns in that outline count.
  CutDepth(const Tool& tool, const ToolPose& from, const ToolPose& to, double ignored_mm,
           DexelSnapshot before, DexelSnapshot after, const std::vector<FieldTile>& cut,
           const ConvexOutline* within = nullptr);
  CutDepth(const CutDepth&) = delete;
  CutDepth& operator=(const CutDepth&) = delete;

  /// Continues until about so many distances from the sweep have been computed. Returns true when
  /// everything is measured. One takes about a microsecond along a straight path.
  bool advance(std::size_t distances);
  /// Returns the depth found so far, mm.
  double depth_mm() const { return depth_mm_; }

 private:
  void measure(std::int32_t i, std::int32_t j);
  void measure(std::int32_t i, std::int32_t j, const Dexel& removed);
  double sought_mm() const;
  bool is_deepest() const;
  bool is_shallow(const Dexel& removed, std::span<const Dexel> left) const;

  ToolProfile profile_;
  MovingTool motion_;
  double ignored_mm_;
  const ConvexOutline* within_;
  ChangedRows rows_;
  double depth_mm_ = 0;
  std::size_t distances_ = 0;
  std::vector<Dexel> whole_, left_, removed_;
};

}  // namespace kerf
