// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/dexel/dexel_field.h"
#include "kernel/force/engagement.h"
#include "kernel/force/milling_elements.h"

namespace kerf {

/// The travel over which a motion delivers a cut (CuttingForce::finish).
struct MillingTravel {
  double crossing_mm = 0, path_mm = 0;   ///< over which the motion's own cut enters the two queues
  double gradual_mm = 0, prompt_mm = 0;  ///< by which the two queues advance
  double due_path_mm = 0;                ///< mean path of the delivered amounts
  double crossing_per_mm = 1;            ///< of the last cut: crossing_mm over path_mm
  bool rests = false;
  /// Shares of the amounts that earlier motions left in the two queues and that are still felt.
  double gradual_kept = 1, prompt_kept = 1;
};

/// The wrench of one motion by the mechanistic law (kernel/force/mechanistic.md).
class MillingForce {
 public:
  /// `axis` is that of the tool at the start of the motion; `zero` is MillingEngagement::zero.
  MillingForce(const MillingSettings& settings, const Tool& tool, Vec3 axis, Vec3 zero,
               double duration_s);

  /// Adds the elements that one sub-motion removed from a field. `twist` and `frame` are in the
  /// field's frame, `share` is its part of the duration, and `gradual` is the share of the cut that
  /// passes through the queue of that name.
  void add(const Removal& removal, const DexelField& field, const Twist& twist,
           const CutFrame& frame, double share, double gradual, bool weighted);

  /// Ends the motion and returns its wrench about the tool's pivot.
  Wrench finish(MillingEngagement& engagement, const MillingTravel& travel) const;

 private:
  double turns_per_s() const { return settings_.spindle_rpm / 60; }
  double feed_per_tooth_mm(double path_mm, double duration_s) const;
  Wrench at(const MillingSpectrum& spectrum, double turns, double duration_s) const;

  MillingSettings settings_;
  Harmonics harmonics_;
  ToolSide side_;
  Vec3 axis_, zero_;
  double duration_s_;
  MillingSum gradual_, prompt_;
};

/// Returns an estimate of the cutting force, N, at a rate of removal, for motions without a
/// computed force: that of the tangential and radial coefficients at the full radius of the tool.
double milling_force_n(const MillingSettings& settings, double radius_mm, double mm3_per_s);

}  // namespace kerf
