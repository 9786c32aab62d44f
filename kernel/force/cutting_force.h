// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/force/cut_sum.h"
#include "kernel/force/engagement.h"
#include "kernel/force/force_settings.h"
#include "kernel/force/surface_weight.h"
#include "kernel/math/wrench.h"
#include "kernel/sweep/tool_motion.h"
#include "kernel/tool/tool.h"

namespace kerf {

/// What is felt of a cut, as a mean over a motion.
struct FeltCut {
  Wrench wrench;          ///< force (N), torque about the pivot (N·mm)
  double volume_mm3 = 0;  ///< of it; over a cut the sum is that of what was removed
  double area_mm2 = 0;    ///< engaged: volume / path of the contact
  Vec3 center_mm;         ///< middle of the volume; meaningless while area is zero
};

/// Sums the force–torque of a motion over its sub-motions and fields (paper section 3, Eqs. 18–24,
/// per unit time), and delivers it as kernel/README.md derives ("Force").
class CuttingForce {
 public:
  /// `motion` is the whole motion in the world and `duration_s` its time, > 0. `fields` of rays (1
  /// or 3) see it. `engagement` is that of the hand.
  CuttingForce(const ForceSettings& settings, const Tool& tool, const ToolMotion& motion,
               double duration_s, int fields, Engagement& engagement);

  /// Adds what one sub-motion removed from the field that stands on `grid`; `motion` is the
  /// sub-motion in that field's own frame (grid.axis), `share` its part of the duration.
  void add(const DexelGrid& grid, const Removal& removal, const ToolMotion& motion, double share,
           Workers& workers);

  /// Ends the motion: what the hand feels of it. To be called once.
  FeltCut finish();

 private:
  /// Sums of the motion, and what they are per mm of travel.
  struct Part {
    CutSum sum;
    double per_mm_mm2 = 0;
    void add(const CutSum& s, double share, double path_mm);
    /// The travel that this was removed on, or `otherwise` if nothing was.
    double path_mm(double otherwise) const;
  };
  CutSum carried(TravelQueue& queue, double path_mm, Vec3 way) const;

  ForceSettings settings_;
  const ToolMotion& motion_;
  double reach_mm_, radius_mm_;  ///< of the tool
  double duration_s_;
  std::optional<SurfaceWeight> weight_;  ///< of three fields
  Engagement& engagement_;
  Part all_, gradual_;
};

}  // namespace kerf
