// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/carve/carve_options.h"

namespace kerf {

/// Runs kerf-carve: reads the scene and the program, cuts, and writes the requested files. Returns
/// the exit status: 0; 2 for bad input, 1 if an output cannot be written, 130 after SIGINT and 143
/// after SIGTERM (at most a second later), each with one line on stderr and without output files.
int run_carve(const CarveOptions& options);

}  // namespace kerf
