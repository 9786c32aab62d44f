// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "server/store/sqlite.h"

namespace kerf {

/// Copies the rows of a journal's table (journal_tables.h), or those that satisfy the expression
/// `where`, into another journal. Creates the table if it is missing. After an error, e.g. a
/// damaged page, the rows before it are copied.
SqlResult<void> copy_table(SqlDatabase& from, SqlDatabase& to, std::string_view name,
                           const std::string& where);

}  // namespace kerf
