// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/options.h"

namespace kerf::agent {

/// Exit code of an agent that did not reach its end.
inline constexpr int kFailed = 1;

/// Joins the session, runs the device until it ends, the duration has passed or a signal arrives,
/// and prints the summary. Returns the exit code: 0, or kFailed if the server was unreachable,
/// rejected the agent, or was lost for good.
int run_agent(Options options);

}  // namespace kerf::agent
