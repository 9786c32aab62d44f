// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kerf::bench {

/// Prints the price of twelve programs as predicted from a sample, and as measured by carving them:
/// CPU time of a motion, and growth of the process's memory. `files` lists additional programs,
/// each as a scene and a program. Returns false if a file cannot be read.
bool print_price_table(const std::vector<std::string>& files);

}  // namespace kerf::bench
