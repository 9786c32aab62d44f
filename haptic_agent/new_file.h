// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <fstream>
#include <string>

namespace kerf::agent {

// Each creates a file for writing and fails if it exists, so that no file is overwritten. The error
// is one sentence without its full stop.

/// Returns the file's descriptor, which the caller closes.
std::expected<int, std::string> new_file(const std::string& path);
std::expected<std::ofstream, std::string> new_text_file(const std::string& path);

}  // namespace kerf::agent
