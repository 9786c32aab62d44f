// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace kerf {

/// Most holes of a pattern.
inline constexpr int kPatternHolesMax = 10'000;

/// A point of a pattern of holes, from the pattern's reference point, in the program's unit.
struct PatternHole {
  double x = 0, y = 0;
};

/// Points on a circle about the reference point, from the angle `first_deg` on, `step_deg` apart.
std::vector<PatternHole> holes_on_circle(int count, double radius, double first_deg,
                                         double step_deg);
/// Points on a line in the direction `deg`, from the distance `first` on, `step` apart.
std::vector<PatternHole> holes_on_line(int count, double first, double step, double deg);
/// Points of a grid, from the reference point on, row by row, back and forth. The whole grid is
/// turned by `deg` about the reference point.
std::vector<PatternHole> holes_on_grid(int columns, int rows, double column_step, double row_step,
                                       double deg);

}  // namespace kerf
