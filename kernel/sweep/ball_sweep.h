// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kernel/intersect/ray_capsule.h"
#include "kernel/sweep/column_block.h"

namespace kerf {

/// A ball whose center moves along a chain of straight lines: one capsule for each line. Exact for
/// any motion of the tool's axis.
class BallSweep {
 public:
  /// `centers_mm` has at least two points. `start_is_cut` states that the ball at the first center
  /// has already been removed from the stock, so only the region into which it advances is visited.
  BallSweep(const std::vector<Vec3>& centers_mm, double radius_mm, bool start_is_cut);

  SweepBounds bounds() const;
  /// Lowers `z_mm` to a lower bound of the heights that are removed within each disc. Returns the
  /// discs (bit i: disc i) that are left out because they are behind the ball.
  LeftOut lower_bound(const Discs& discs, Lanes& z_mm) const;
  void evaluate(ColumnBlock& block) const;

  /// Returns whether the center stays at or above a height. Below it, a ray that the ball meets
  /// then loses everything above the ball's lower end.
  bool stays_above(double z_mm) const;
  std::span<const RayCapsule> capsules() const { return capsules_; }

 private:
  std::vector<RayCapsule> capsules_;
  double radius_;
  bool start_is_cut_;
};

}  // namespace kerf
