// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf::bench {

/// Prints the ripple of side cuts by radial engagement, for two diameters and one or three fields.
void print_light_cuts(double pitch_mm);

}  // namespace kerf::bench
