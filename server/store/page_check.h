// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>

#include "server/store/journal_error.h"

namespace kerf {

/// Reads all pages of a journal, including tables that readers of records do not need: a damaged
/// page would stop the session when it writes there. Compares the names of its tables. May run in
/// parallel with a writer of the file. Takes about as long as reading the file.
std::expected<void, JournalError> check_pages(const std::filesystem::path& journal);

}  // namespace kerf
