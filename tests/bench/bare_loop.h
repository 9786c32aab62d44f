// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernel/tool/tool_pose.h"

namespace kerf::test {

/// Tools that bare loops support: diameter 10 mm; the corner of the bull-nose has the radius 2 mm.
enum class BareTool { kBall, kFlat, kBullNose };

/// Runs the standard job on a bare height map as an upper bound of the speed of one core: single
/// precision, sums in any order, one number per column, no interval lists. Computes the removed
/// volume and its moments, as the force requires.
///
/// A tool that stays upright moves horizontally, and its lower envelope is exact. If the axis
/// turns, a ball makes one sub-motion: it is intersected at both ends of the move, and translated
/// between them with the axis of the middle. Flat and bull-nose are intersected at the two ends
/// only, which is less than any sweep needs. Material above a leaning tool is removed too.
class BareLoop {
 public:
  BareLoop(BareTool tool, double pitch_mm);
  void move(const ToolPose& from, const ToolPose& to);
  double removed_mm3() const;

  /// Sums over the columns of a move, in units of the pitch squared.
  struct Sums {
    float volume = 0, x = 0, z = 0;
  };
  /// The columns of a row, and the position of the first one's center.
  struct Row {
    float* tops;
    int count;
    float pitch, x, y;
  };

 private:
  template <class Surface>
  void cut(const Surface& surface, Vec3 min_mm, Vec3 max_mm);

  BareTool tool_;
  int columns_;
  float pitch_;
  std::vector<float> top_;
  double volume_ = 0, moment_x_ = 0, moment_y_ = 0, moment_z_ = 0;
};

}  // namespace kerf::test
