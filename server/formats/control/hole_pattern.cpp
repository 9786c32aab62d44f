// SPDX-License-Identifier: Apache-2.0
#include "server/formats/control/hole_pattern.h"

#include <cmath>

#include "server/formats/units.h"

namespace kerf {

std::vector<PatternHole> holes_on_circle(int count, double radius, double first_deg,
                                         double step_deg) {
  std::vector<PatternHole> holes;
  for (int i = 0; i < count; ++i) {
    const double angle = kRadPerDeg * (first_deg + step_deg * i);
    holes.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return holes;
}

std::vector<PatternHole> holes_on_line(int count, double first, double step, double deg) {
  const double c = std::cos(kRadPerDeg * deg), s = std::sin(kRadPerDeg * deg);
  std::vector<PatternHole> holes;
  for (int i = 0; i < count; ++i) holes.push_back({c * (first + i * step), s * (first + i * step)});
  return holes;
}

std::vector<PatternHole> holes_on_grid(int columns, int rows, double column_step, double row_step,
                                       double deg) {
  const double c = std::cos(kRadPerDeg * deg), s = std::sin(kRadPerDeg * deg);
  std::vector<PatternHole> holes;
  for (int row = 0; row < rows; ++row)
    for (int i = 0; i < columns; ++i) {
      const double x = (row % 2 == 0 ? i : columns - 1 - i) * column_step, y = row * row_step;
      holes.push_back({c * x - s * y, s * x + c * y});
    }
  return holes;
}

}  // namespace kerf
