// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "server/carve/gouges.h"
#include "server/carve/simulation.h"

namespace kerf {

/// Returns the "simulation" object of the report as JSON text; README.md defines its fields.
/// `tool_change_s` is the duration of a tool change; `gouges` is present if a reference was given.
std::string simulation_json(const Simulation& simulation, double tool_change_s,
                            const std::optional<Gouges>& gouges);

/// Adds a warning for each line whose rapids removed material and for each gouge, at most 20 of
/// each.
void warn_of_simulation(const Simulation& simulation, const std::optional<Gouges>& gouges,
                        std::vector<std::string>& warnings);

}  // namespace kerf
