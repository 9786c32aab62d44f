// SPDX-License-Identifier: Apache-2.0
#include "server/store/batch_insert.h"

#include <cstdint>

namespace kerf {

SqlResult<SqlStatement> prepare_batch_insert(SqlDatabase& database) {
  return database.prepare("INSERT INTO batches VALUES(?,?,?,?,?,?)");
}

SqlResult<void> insert_batch(SqlStatement& insert, const BatchHead& head,
                             std::span<const std::byte> bytes) {
  insert.bind(1, static_cast<std::int64_t>(head.first));
  insert.bind(2, static_cast<std::int64_t>(head.count));
  insert.bind(3, head.wall_ms);
  insert.bind(4, head.span_ms);
  insert.bind(5, bytes);
  insert.bind(6, batch_checksum(head, bytes));
  if (auto row = insert.step(); !row) return std::unexpected(row.error());
  return {};
}

}  // namespace kerf
