// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerf::test {

/// Prints a table over the tool shapes: CPU time of a translation of 1 mm and of a tick of a hand
/// (0.1 mm and 0.25 degrees), median and p99, force and torque included, and moves per second of
/// the first rows of the standard job in three and five axes, with the ratio for a tolerance of 0.1
/// mm in five axes. The time of each motion is the best of `repetitions` runs of its job. If `only`
/// is not empty, prints only that shape.
void print_shape_table(double pitch_mm, double tolerance_mm, int repetitions,
                       const std::string& only);

}  // namespace kerf::test
