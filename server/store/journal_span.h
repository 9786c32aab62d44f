// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <vector>

#include "server/store/journal_error.h"

namespace kerf {

/// Returns the rows that hold the records `first` to `last` of a journal, and those before them
/// that are needed to decode them, as a span (record_span.h). Reads beside the writer. The span of
/// two numbers never changes. Empty: not all of these records are committed. Records of version 1
/// are in no rows: kForeignVersion.
std::expected<std::vector<std::byte>, JournalError> journal_span(
    const std::filesystem::path& journal, std::uint64_t first, std::uint64_t last);

}  // namespace kerf
