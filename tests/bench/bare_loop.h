// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernel/math/vec3.h"

namespace kerf::test {

/// What one core can do on the three-axis standard job: a bare height map under a ball of 10 mm
/// that moves level, in floats, with sums in any order; one number a column, no interval list, no
/// other tool. Volume and its moments as the force needs them.
class BareLoop {
 public:
  explicit BareLoop(double pitch_mm);
  void move(Vec3 from_mm, Vec3 to_mm);
  double removed_mm3() const;

 private:
  int columns_;
  float pitch_;
  std::vector<float> top_;
  double volume_ = 0, moment_x_ = 0, moment_y_ = 0, moment_z_ = 0;
};

}  // namespace kerf::test
