// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

namespace kerf::agent {

/// Runs `kerf-agent doctor`: reports what is missing for carving with a device, and measures the
/// servo loop. `argv[0]` is "doctor". Returns 0: all checks passed; 1: some did not; 2: bad command
/// line.
int run_doctor(int argc, const char* const* argv, std::ostream& out);

}  // namespace kerf::agent
