// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "server/formats/program_reader.h"

namespace kerf {

/// Reads a SINUMERIK program for a scene. README.md lists the statements; any other is an error
/// that names it. `lines_max` limits the executed lines. `reason`, unless empty, is the first
/// warning: why this dialect was chosen.
std::expected<ReadProgram, ProgramError> read_sinumerik(const std::string& name,
                                                        std::string_view text, const Scene& scene,
                                                        std::size_t lines_max,
                                                        ProgramVisitor& visitor,
                                                        const std::string& reason = {});

}  // namespace kerf
