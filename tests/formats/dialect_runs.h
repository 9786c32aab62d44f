// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/formats/program_error.h"
#include "tests/formats/canon_record.h"
#include "tests/formats/scene_fixture.h"

namespace kerf::test {

/// An environment that reads a program in a controller's dialect.
inline GcodeEnvironment as(Dialect dialect) { return GcodeEnvironment{.dialect = dialect}; }

/// The moves of a program for Fanuc, or for Haas, in the format of moves_of().
inline std::string fanuc(const std::string& text) { return moves_of(text, as(Dialect::kFanuc)); }
inline std::string haas(const std::string& text) { return moves_of(text, as(Dialect::kHaas)); }

/// Returns the error with which a program is rejected.
inline std::string refused(const std::string& text, Dialect dialect = Dialect::kFanuc) {
  return to_string(run_error_of(text, as(dialect)));
}

}  // namespace kerf::test
