// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/carve/part_fit.h"
#include "server/carve/simulation.h"

namespace kerf {

/// Returns the "simulation" object of the report as JSON text. README.md defines its fields.
/// `tool_change_s` is the duration of a tool change.
std::string simulation_json(const Simulation& simulation, double tool_change_s, const PartFit& fit);

/// Adds a warning for each line whose rapids removed material and for each gouge and rest, at most
/// 20 of each.
void warn_of_simulation(const Simulation& simulation, const PartFit& fit,
                        std::vector<std::string>& warnings);

}  // namespace kerf
