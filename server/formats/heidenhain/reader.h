// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "server/formats/program.h"

namespace kerf {

/// Reads a HEIDENHAIN Klartext program for a scene; read_gcode calls it for programs that begin
/// with BEGIN PGM. README.md lists the statements; any other statement is an error that names it.
/// `lines_max` bounds the blocks that are executed.
std::expected<Program, ProgramError> read_klartext(const std::string& name, std::string_view text,
                                                   const Scene& scene, std::size_t lines_max);

}  // namespace kerf
