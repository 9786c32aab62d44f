// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

namespace kerf::agent {

/// Runs `kerf-agent doctor`: reports problems that prevent carving with a device, and measures the
/// servo loop. `argv[0]` is "doctor". Returns 0 if all checks passed, 1 if some did not, 2 for an
/// invalid command line.
int run_doctor(int argc, const char* const* argv, std::ostream& out);

}  // namespace kerf::agent
