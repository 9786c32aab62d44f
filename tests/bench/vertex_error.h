// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf {

/// Carves `jobs` blocks by random five-axis jobs, each with one of every tool and with one field of
/// rays or three in turn, from seed `first` on. Prints, for each tool and ray model, the distances
/// of the vertices of the meshes from the true solid (TrueSweep), in pitches: the greatest with its
/// seed, the bounds that 999 of 1000 and 99 of 100 are within, and how many exceed a half; and the
/// number of crossing pairs of triangles.
void print_vertex_errors(unsigned first, unsigned jobs);

}  // namespace kerf
