// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf {

/// Prints for one field of rays and for three how far the mesh of random five-axis carvings with
/// every tool is off the true sweeps, in pitches: everywhere, and away from features below the
/// pitch (FineSurface::plain within one pitch).
void print_feature_errors();

}  // namespace kerf
