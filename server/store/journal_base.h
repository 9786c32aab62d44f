// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "server/store/sqlite.h"

namespace kerf {

/// A salvaged journal begins with a block that tools have cut already: its file of this name, which
/// ends with the number of the record before its first one, is a snapshot of that block.
inline constexpr const char* kBaseName = "kerf-base-";

std::string base_name(std::uint64_t record);
/// The number of the record before the first one of a journal with these files (JournalHeader);
/// 0: it begins with the untouched stock, as all others do.
std::uint64_t base_record(const std::map<std::string, std::string>& files);
SqlResult<std::uint64_t> base_record(SqlDatabase& database);
/// The snapshot with which the journal begins; null if there is none.
const std::string* base_of(const std::map<std::string, std::string>& files);

}  // namespace kerf
