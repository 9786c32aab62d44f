// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/carve/tradeoff_table.h"

namespace kerf {

/// Returns the rows as an SVG plot: surface, volume and force error against CPU time per motion, on
/// logarithmic axes, each with its Pareto front.
std::string tradeoff_svg(const std::vector<TradeoffRow>& rows, const std::string& title,
                         const std::string& note);

}  // namespace kerf
