// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/carve/tradeoff_table.h"

namespace kerf {

/// The rows as an SVG picture: surface error, volume error and force error against CPU time per
/// motion, both axes logarithmic, each with the front of what is measured there.
std::string tradeoff_svg(const std::vector<TradeoffRow>& rows, const std::string& title,
                         const std::string& note);

}  // namespace kerf
