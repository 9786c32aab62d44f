// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf {

/// Prints, for one field of rays and for three, the self-intersections and the triangles without
/// area of the standard jobs, of 200 random carvings and of 4,000 small blocks with slots at
/// quarters of the pitch, counted with exact predicates (tests/support/self_intersection.h).
void print_crossings();

}  // namespace kerf
