// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/carve/tradeoff_options.h"

namespace kerf {

/// Carves a program with many accuracy settings, prints the cost and error of each, and writes the
/// requested files. Returns the exit status like run_carve(). After SIGINT or SIGTERM it prints the
/// measured rows and writes no file.
int run_tradeoff(const TradeoffOptions& options);

}  // namespace kerf
