// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>

#include "server/store/journal_error.h"

namespace kerf {

/// Returns the last committed record that was appended at or before a time, ms since 1970, UTC; 0
/// if none was. Times of records are accurate to about 10 ms. If the server's clock was set back,
/// the last batch that began by then counts. Records of version 1 have no time and count as oldest.
std::expected<std::uint64_t, JournalError> record_at(const std::filesystem::path& journal,
                                                     std::int64_t wall_ms);
/// Returns when a committed record was appended, ms since 1970, UTC. 0 if unknown, as for records
/// of version 1, or if there is no such record.
std::expected<std::int64_t, JournalError> time_of(const std::filesystem::path& journal,
                                                  std::uint64_t record);

}  // namespace kerf
