// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "server/store/list_table.h"

namespace kerf {

/// A name for the block after a record, without the strokes that were undone then.
struct NamedVersion {
  std::string name;
  std::uint64_t record = 0;
  std::int64_t record_ms = 0;   ///< when the record was appended; ms since 1970, UTC; 0 if unknown
  std::int64_t created_ms = 0;  ///< when it was named
  std::string author;           ///< name of the person who named it; empty if unknown
  std::string person;           ///< grant of that person; empty if none
};

/// Maximum number of versions in a session.
inline constexpr std::size_t kVersionsMax = 1000;

/// Converts a version to its row in the table `versions` of the journal, and back.
ListRow to_row(const NamedVersion& version);
NamedVersion version_of(const ListRow& row);

}  // namespace kerf
