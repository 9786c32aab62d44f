#pragma once

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/force/force_settings.h"
#include "kernel/force/wrench.h"
#include "kernel/sweep/tool_motion.h"

namespace kerf {

/// Sums the force–torque of a motion over its sub-motions (paper section 3, Eqs. 18–24, per unit
/// time).
class CuttingForce {
 public:
  /// `duration_s` is that of the whole motion, > 0. `fields` of rays (1 or 3) see the same motion;
  /// the result is their mean.
  CuttingForce(const ForceSettings& settings, double duration_s, int fields = 1);

  /// Adds what one sub-motion removed from the field that stands on `grid`; `motion` is the
  /// sub-motion in that field's own frame (grid.axis), `share` its part of the duration.
  void add(const DexelGrid& grid, const Removal& removal, const ToolMotion& motion, double share);

  /// Mean over the motion: force (N), torque about the pivot (N·mm).
  Wrench wrench() const { return sum_; }
  /// Volume centre of what was removed (mm); meaningless while nothing was.
  Vec3 center_mm() const { return moment_ * (1 / volume_mm3_); }
  double volume_mm3() const { return volume_mm3_; }
  /// Mean engaged area A = removed volume / path of the contact (mm^2).
  double engaged_area_mm2() const { return area_mm2_; }

 private:
  ForceSettings settings_;
  double duration_s_;
  double weight_;  ///< of one field
  Wrench sum_;
  Vec3 moment_;
  double volume_mm3_ = 0;
  double area_mm2_ = 0;
};

}  // namespace kerf
