// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kerf::bench {

/// Prints the price of twelve programs as a sample of them says it, and as carving them whole
/// measures it: CPU time of a motion, and memory by which the process grows. `files`: further
/// programs, each a scene and a program. Returns false if a file cannot be read.
bool print_price_table(const std::vector<std::string>& files);

}  // namespace kerf::bench
