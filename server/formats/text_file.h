// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace kerf {

/// Reads a whole file. Returns nullopt if it cannot be opened or read, for example because it is a
/// folder.
std::optional<std::string> read_file(const std::filesystem::path& path);

}  // namespace kerf
