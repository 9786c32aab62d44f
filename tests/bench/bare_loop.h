// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernel/math/vec3.h"

namespace kerf::test {

/// Runs the three-axis standard job on a bare height map as an upper bound of the speed of one
/// core: a 10 mm ball in horizontal translation, single precision, sums in any order, one number
/// per column, no interval lists and no other tool. Computes the removed volume and its moments, as
/// the force requires.
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
