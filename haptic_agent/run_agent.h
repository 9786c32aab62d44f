// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/options.h"

namespace kerf::agent {

/// Joins the session, runs the device until it ends, the time is up or a signal asks to leave, and
/// prints the summary. Returns the exit code: 0, or 1 if the server could not be reached, rejected,
/// or was lost for good.
int run_agent(Options options);

}  // namespace kerf::agent
