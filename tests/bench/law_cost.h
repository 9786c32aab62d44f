// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf::bench {

/// Prints the CPU time of a tick of 0.03 mm in a slot 2 mm deep, without a force, and with each
/// force law relative to `specific_energy`: for flat and ball mills and one or three fields.
/// `mechanistic` is measured with mean forces only, and with three frequencies of ripple.
void print_law_costs(double pitch_mm);

}  // namespace kerf::bench
