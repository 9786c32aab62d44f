// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "server/formats/program_reader.h"

namespace kerf {

/// Reads a HEIDENHAIN Klartext program for a scene. read_program calls it for programs that begin
/// with BEGIN PGM. README.md lists the statements. Any other statement is an error that names it.
/// `lines_max` limits the executed blocks.
std::expected<ReadProgram, ProgramError> read_klartext(const std::string& name,
                                                       std::string_view text, const Scene& scene,
                                                       std::size_t lines_max,
                                                       ProgramVisitor& visitor);

}  // namespace kerf
