// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace kerf {

/// The bytes of a file; none if it cannot be opened or read (a folder, for one).
std::optional<std::string> read_file(const std::filesystem::path& path);

}  // namespace kerf
