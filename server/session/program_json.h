// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/session/program_status.h"

namespace kerf {

/// What a list of programs shows of one, as a JSON object; with `elapsed_s` and `remaining_s` of
/// its cycle time at feed rate.
std::string program_json(const ProgramGlance& program);
/// The same with the tools, the warnings and the alarms.
std::string program_json(const ProgramStatus& program);

}  // namespace kerf
