// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/formats/program.h"

namespace kerf {

/// Reads APT CL data for a scene; parse_program calls it for .apt and .cls. `name` is the file name
/// for errors. README.md lists the supported statements; any other statement is an error.
std::expected<Program, ProgramError> read_apt(const std::string& name, std::string_view text,
                                              const Scene& scene);

}  // namespace kerf
