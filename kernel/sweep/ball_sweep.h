// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernel/intersect/ray_capsule.h"
#include "kernel/sweep/column_block.h"

namespace kerf {

/// A ball whose centre moves along a chain of straight lines: a capsule for each. Exact whatever
/// the tool's axis does meanwhile.
class BallSweep {
 public:
  /// `centers_mm` has at least two points. `start_is_cut`: the ball at the first centre has been
  /// removed from the stock already, so only what advances from there is visited.
  BallSweep(const std::vector<Vec3>& centers_mm, double radius_mm, bool start_is_cut);

  SweepBounds bounds() const;
  /// No height below this one is removed within each disc; +inf where nothing is.
  void lower_bound(const Discs& discs, Lanes& z_mm) const;
  void evaluate(ColumnBlock& block) const;

 private:
  std::vector<RayCapsule> capsules_;
  double radius_;
  bool start_is_cut_;
};

}  // namespace kerf
