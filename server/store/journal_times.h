// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>

#include "server/store/journal_error.h"

namespace kerf {

/// Returns the last of the committed records that were appended at a time, or before; 0: none. The
/// time is in ms since 1970, UTC; those of records are right to some 10 ms. If the clock of the
/// server was set back, the last batch that began by then counts. Records of version 1 have no
/// time: they are the oldest ones.
std::expected<std::uint64_t, JournalError> record_at(const std::filesystem::path& journal,
                                                     std::int64_t wall_ms);
/// Returns when a committed record was appended, ms since 1970, UTC; 0: not known, as of records of
/// version 1, or there is none.
std::expected<std::int64_t, JournalError> time_of(const std::filesystem::path& journal,
                                                  std::uint64_t record);

}  // namespace kerf
