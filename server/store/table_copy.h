// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "server/store/sqlite.h"

namespace kerf {

/// Copies the rows of a table of a journal (journal_tables.h) into another journal, which gets the
/// table if it lacks it: all rows, or those for which the expression `where` holds. After an error,
/// as of a damaged page, the rows before it are there.
SqlResult<void> copy_table(SqlDatabase& from, SqlDatabase& to, std::string_view name,
                           const std::string& where);

}  // namespace kerf
