// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "haptic_agent/options.h"

namespace kerf::agent {

/// Splits the options into one set per device: names "Ada", "Ada 2", …, summaries FILE, FILE.2, …,
/// recordings a.mcap, a.2.mcap, …
std::vector<Options> split_options(const Options& options);

/// Runs one agent per device. With several devices each agent has its own process, so that one
/// failure does not affect the rest. Returns the maximum of their exit codes after all have ended.
/// Forwards signals to all.
int run_agents(Options options);

}  // namespace kerf::agent
