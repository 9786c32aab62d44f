// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kernel/sculpture.h"

namespace kerf::paper {

/// Fig. 1 (c) to (e): a block of 10 x 4 thick columns and a ball of 7 mm that lies and moves along
/// Y through it, with its axis at a height; 1 is defined as its tool.
Sculpture columns_cut_at(double height_mm);

/// Returns the table of the four kinds of motion, by both models: errors and cuts of a motion, the
/// same on every run.
std::string kinds_table();
/// Returns the table of the CPU times of general motions: best of `rounds`, both models in turn.
std::string kinds_times(int rounds);

}  // namespace kerf::paper
