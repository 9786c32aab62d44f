// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "server/store/sqlite.h"

namespace kerf {

/// Name of the file in a salvaged journal that holds the block it begins with, as a snapshot. The
/// number of the record before the journal's first one is appended.
inline constexpr const char* kBaseName = "kerf-base-";

std::string base_name(std::uint64_t record);
/// Returns the number of the record before the first one of a journal with these files
/// (JournalHeader). 0 if it begins with untouched stock, like every journal that is not salvaged.
std::uint64_t base_record(const std::map<std::string, std::string>& files);
SqlResult<std::uint64_t> base_record(SqlDatabase& database);
/// Returns the snapshot with which the journal begins; null if there is none.
const std::string* base_of(const std::map<std::string, std::string>& files);

}  // namespace kerf
