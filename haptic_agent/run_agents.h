// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "haptic_agent/options.h"

namespace kerf::agent {

/// The options of each device's own agent: named "Ada", "Ada 2", …, with the summary in FILE,
/// FILE.2, …
std::vector<Options> split_options(const Options& options);

/// Runs an agent for every device; of several, each in a process of its own, so that nothing
/// that befalls one hand takes the force off another. Ends when all have ended, with the greatest
/// of their exit codes; a signal to end goes to all.
int run_agents(Options options);

}  // namespace kerf::agent
