// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <vector>

#include "server/store/journal_error.h"

namespace kerf {

/// Returns the rows with the records `first` to `last` of a journal, and the rows before them
/// needed to decode them, as a span (record_span.h). Runs in parallel with the writer. The span of
/// two given numbers never changes. Empty if not all of the records are committed. Fails with
/// kForeignVersion for records of version 1, which are not in such rows.
std::expected<std::vector<std::byte>, JournalError> journal_span(
    const std::filesystem::path& journal, std::uint64_t first, std::uint64_t last);

}  // namespace kerf
