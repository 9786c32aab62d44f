// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>

namespace kerf::agent {

// Commands that work on a recording and need no server. Each returns the exit code: 0; 1 if the
// device failed or a file could not be written; 2 for an invalid command line or file.

/// `kerf-agent feel FILE.mcap --device DEVICE`: plays the forces that were felt in the strokes of a
/// recording. The tool is kept near their path. As the hand moves along the path, at its own speed,
/// the device outputs the wrench that was felt there. Arming, limits and passivity are those of a
/// session.
int run_feel(int argc, const char* const* argv, std::ostream& out);

/// `kerf-agent export FILE.mcap [TABLE.csv]`: writes a recording as a table (write_csv).
int run_export(int argc, const char* const* argv, std::ostream& out);

}  // namespace kerf::agent
