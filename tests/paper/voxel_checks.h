// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerf::paper {

/// Returns the table of elements, bytes and errors of both models: the same on every run.
std::string voxel_table();
/// Returns the table of their CPU times on this machine: best of `rounds`, both in turn.
std::string voxel_times(int rounds);

}  // namespace kerf::paper
