// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf {

/// Prints, for one field of rays and for three, the number of crossing triangles in the meshes of
/// 200 random carvings, and the number of carvings that contain any. Two triangles without a common
/// corner cross if an edge of one passes through the interior of the other.
void print_crossings();

}  // namespace kerf
