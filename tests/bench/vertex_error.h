// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf {

/// Carves `jobs` blocks by random five-axis jobs, each with one of every tool and with one field of
/// rays or three in turn, from seed `first` on. Prints, for each tool and ray model, the distances
/// of the vertices of the meshes from the true solid (TrueSweep), in pitches: the greatest with its
/// seed, what 999 and 99 of 100 are within, how many exceed a half; and the pairs of triangles that
/// cross.
void print_vertex_errors(unsigned first, unsigned jobs);

}  // namespace kerf
