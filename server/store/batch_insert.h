// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "server/store/record_batch.h"
#include "server/store/sqlite.h"

namespace kerf {

/// Prepares the statement of insert_batch().
SqlResult<SqlStatement> prepare_batch_insert(SqlDatabase& database);
/// Inserts a row, with its checksum, into the table `batches`. `bytes`: the encoded records.
SqlResult<void> insert_batch(SqlStatement& insert, const BatchHead& head,
                             std::span<const std::byte> bytes);

}  // namespace kerf
