// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf {

/// Prints for one field of rays and for three in how many of 200 random carvings triangles of the
/// mesh cross each other, and how many do: of pairs that share no corner, those where an edge of
/// one passes through the inside of the other.
void print_crossings();

}  // namespace kerf
