// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/force/cut_sum.h"
#include "kernel/force/engagement.h"
#include "kernel/force/force_settings.h"
#include "kernel/force/milling_force.h"
#include "kernel/force/surface_weight.h"
#include "kernel/math/wrench.h"
#include "kernel/sweep/tool_motion.h"
#include "kernel/tool/tool.h"

namespace kerf {

/// The part of a cut that a motion delivers as force, as a mean over the motion.
struct FeltCut {
  Wrench wrench;          ///< force (N), torque about the pivot (N·mm)
  double volume_mm3 = 0;  ///< delivered; over a whole cut the sum equals the removed volume
  double area_mm2 = 0;    ///< engaged area: volume / path of the contact
  Vec3 center_mm;         ///< centroid of the volume; meaningless while area is zero
};

/// Returns the summer of a sub-motion, given its motion in the frame of the field, which must
/// outlive it. `weight` is set for three fields, else null.
CutSummer make_summer(const ForceSettings& settings, const Tool& tool, const DexelField& field,
                      const ToolMotion& motion, const SurfaceWeight* weight);

/// Sums the force and torque of a motion over its sub-motions and fields (paper section 3, Eqs.
/// 18–24, per unit time) and distributes it over the travel that follows (kernel/force/README.md).
class CuttingForce {
 public:
  /// `motion` is the whole motion in world coordinates and `duration_s` its time, > 0. `fields` is
  /// the number of ray fields, 1 or 3. `engagement` is that of the tool's user.
  CuttingForce(const ForceSettings& settings, const Tool& tool, const ToolMotion& motion,
               double duration_s, int fields, Engagement& engagement);

  /// Adds the removal of one sub-motion from a field: `sums` over its tiles, computed by `summer`.
  /// `removal` has the elements, which only the mechanistic law reads. `share` is the sub-motion's
  /// part of the duration.
  void add(const DexelField& field, const CutSummer& summer, const TileSum& sums,
           const Removal& removal, double share);

  /// Ends the motion and returns its force. Must be called once.
  FeltCut finish();

 private:
  /// Sums over the motion, and their volume times the path that they would have over the whole
  /// motion.
  struct Part {
    CutSum sum;
    double swept_mm4 = 0;
    /// `path_mm` is the mean path of the elements in the sub-motion, and `share` > 0 its part of
    /// the motion.
    void add(const CutSum& s, double share, double path_mm);
    /// Returns the mean path over which `sum` was removed, or 0 if nothing was.
    double path_mm() const;
  };
  CutSum not_driving(CutSum due, Vec3 direction) const;

  ForceSettings settings_;
  const ToolMotion& motion_;
  double duration_s_;
  bool weighted_;  ///< there are three fields
  Engagement& engagement_;
  std::optional<MillingForce> milling_;  ///< set if the law is mechanistic
  Part all_, gradual_;
};

}  // namespace kerf
