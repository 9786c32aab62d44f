// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/options.h"

namespace kerf::agent {

/// Joins the session, runs the device until it ends, the duration has passed or a signal arrives,
/// and prints the summary. Returns the exit code: 0, or 1 if the server could not be reached,
/// rejected the agent, or was lost for good.
int run_agent(Options options);

}  // namespace kerf::agent
