// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/formats/program_reader.h"

namespace kerf {

/// Reads APT CL data for a scene. read_program calls it for files of APT. `name` is the file name
/// for errors. README.md of this folder lists the statements. Unknown statements that could move
/// the tool are errors, all other unknown statements warnings.
std::expected<ReadProgram, ProgramError> read_apt(const std::string& name, std::string_view text,
                                                  const Scene& scene, ProgramVisitor& visitor);

}  // namespace kerf
