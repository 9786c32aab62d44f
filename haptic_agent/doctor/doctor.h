// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

namespace kerf::agent {

/// `kerf-agent doctor`: says in plain words what is missing for carving with a device, and measures
/// the loop. `argv[0]` is "doctor". 0: all is fine; 1: something is not; 2: bad command line.
int run_doctor(int argc, const char* const* argv, std::ostream& out);

}  // namespace kerf::agent
