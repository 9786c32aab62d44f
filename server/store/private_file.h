// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <system_error>

namespace kerf {

/// Creates an empty file that only its user may read and write (mode 0600); fails with file_exists
/// if it is there. SQLite gives the files beside a database the mode of the database.
std::error_code create_private_file(const std::filesystem::path& file);

/// Creates a folder, and those above it that are missing, for its user only (mode 0700). One that
/// is there stays as it is.
std::error_code create_private_folder(const std::filesystem::path& folder);

}  // namespace kerf
