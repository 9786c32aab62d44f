// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf::bench {

/// Prints the worst force and torque of motions that start where the tool is buried in stock,
/// relative to the steady ones of the same cut: for every tool shape, both ray models and both
/// force laws. 1 is ideal; the imprint of the tool, counted as a cut, would give 10 to 1000.
void print_buried_starts(double pitch_mm);

}  // namespace kerf::bench
