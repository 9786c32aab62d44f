// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <system_error>

namespace kerf {

/// Creates an empty file that only its user can read and write (mode 0600). Fails with file_exists
/// if it exists. SQLite's side files get the mode of their database.
std::error_code create_private_file(const std::filesystem::path& file);

/// Creates a folder and its missing parents for its user only (mode 0700). Existing ones are not
/// changed.
std::error_code create_private_folder(const std::filesystem::path& folder);

}  // namespace kerf
