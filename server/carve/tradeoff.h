// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/carve/tradeoff_options.h"

namespace kerf {

/// Carves a program at many accuracies, prints what each costs and how far off it is, and writes
/// what was asked for. The exit status, as run_carve's.
int run_tradeoff(const TradeoffOptions& options);

}  // namespace kerf
