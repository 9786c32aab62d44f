// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "server/carve/gouges.h"
#include "server/carve/simulation.h"

namespace kerf {

/// The "simulation" object of the report as JSON text; README.md tells every field.
/// `tool_change_s`: what one tool change takes. `gouges`: where a reference was given.
std::string simulation_json(const Simulation& simulation, double tool_change_s,
                            const std::optional<Gouges>& gouges);

/// Adds a warning for each line whose rapids went through material and for each gouge, the first 20
/// of each.
void warn_of_simulation(const Simulation& simulation, const std::optional<Gouges>& gouges,
                        std::vector<std::string>& warnings);

}  // namespace kerf
