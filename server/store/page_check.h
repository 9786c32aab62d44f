// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>

#include "server/store/journal_error.h"

namespace kerf {

/// Reads all pages of a journal, also of tables that a reader of its records does not need: a
/// damaged one stops the session when it writes there. May run beside a writer of the same file.
/// Takes about as long as reading the file.
std::expected<void, JournalError> check_pages(const std::filesystem::path& journal);

}  // namespace kerf
