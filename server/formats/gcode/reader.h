#pragma once

#include "server/formats/program.h"

namespace kerf {

/// Reads RS-274 as LinuxCNC does; see README.md for what is understood.
std::expected<Program, ProgramError> read_gcode(const std::string& name, std::string_view text,
                                                const Scene& scene);

}  // namespace kerf
