// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/formats/program.h"

namespace kerf {

/// Reads APT CL data; see README.md for what is understood.
std::expected<Program, ProgramError> read_apt(const std::string& name, std::string_view text,
                                              const Scene& scene);

}  // namespace kerf
