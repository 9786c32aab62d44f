// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf {

/// Prints, for one field of rays and for three, the distance between the mesh of random five-axis
/// carvings with every tool and the true sweeps, in pitches: everywhere, and away from features
/// smaller than the pitch (FineSurface::plain within one pitch).
void print_feature_errors();

}  // namespace kerf
