// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf::test {

/// Prints a table over the tool shapes: CPU time per move of the first rows of the standard job in
/// three and five axes at four pitches, with one field of rays and with three, force and torque
/// included, best and median of `repetitions`; the same for the bare loops of ball, flat and
/// bull-nose; and the exponent of the growth of time with 1/pitch.
void print_growth_table(double tolerance_mm, int repetitions);

}  // namespace kerf::test
