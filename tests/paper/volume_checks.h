// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kernel/sculpture.h"

namespace kerf::paper {

/// Fig. 1 (c) to (e): returns a block of 10 x 4 thick columns, cut by a horizontal ball mill of 7
/// mm that moves along Y through it with its axis at a height. Its tool has the id 1.
Sculpture columns_cut_at(double height_mm);

/// Returns the table of the four kinds of motion, by both models: errors and cuts of a motion, the
/// same on every run.
std::string kinds_table();
/// Returns the table of the CPU times of general motions: best of `rounds`, both models in turn.
std::string kinds_times(int rounds);

}  // namespace kerf::paper
