// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/carve/carve_options.h"

namespace kerf {

/// Carves: reads the scene and the program, cuts, writes what was asked for. The exit status: 0; 2
/// where the input is bad, 1 where the output cannot be written, 130 where it was interrupted, each
/// with one line on stderr and no output file.
int run_carve(const CarveOptions& options);

}  // namespace kerf
