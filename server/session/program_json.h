// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/session/program_status.h"

namespace kerf {

/// Returns a list entry of a program as a JSON object. `elapsed_s` and `remaining_s` are parts of
/// its cycle time at feed rate.
std::string program_json(const ProgramGlance& program);
/// Like the one above, with the tools, warnings and alarms.
std::string program_json(const ProgramStatus& program);

/// Parses the output of program_json(ProgramGlance). Nullopt if the text is not such an object.
std::optional<ProgramGlance> parse_program_glance(std::string_view json);

}  // namespace kerf
