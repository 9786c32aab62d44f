// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/session/program_status.h"

namespace kerf {

/// What a list of programs shows of one, as a JSON object; with `elapsed_s` and `remaining_s` of
/// its cycle time at feed rate.
std::string program_json(const ProgramGlance& program);
/// The same with the tools, the warnings and the alarms.
std::string program_json(const ProgramStatus& program);

/// Reads the first back; nullopt for text that is no such object.
std::optional<ProgramGlance> parse_program_glance(std::string_view json);

}  // namespace kerf
