// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/sqlite.h"

namespace kerf {

/// A name for the block as it was after a record, without the strokes that were undone then.
struct NamedVersion {
  std::string name;
  std::uint64_t record = 0;
  std::int64_t record_ms = 0;   ///< when the record was appended; ms since 1970, UTC; 0: unknown
  std::int64_t created_ms = 0;  ///< when it was named
  std::string author;           ///< name of who named it; empty: unknown
  std::string person;           ///< its grant; empty: none
};

/// A version that is stored, renamed, or removed.
struct VersionChange {
  NamedVersion version;
  bool is_removed = false;
  std::string old_name;  ///< of a version that is renamed: its row goes; empty: there is none
};

inline constexpr std::size_t kVersionNameBytesMax = 64;
/// Versions of a session.
inline constexpr std::size_t kVersionsMax = 1000;

/// Whether a text can name a version: UTF-8 of 1 to 64 bytes without control characters and "/".
bool is_version_name(std::string_view name);

/// Creates the table unless it is there.
SqlResult<void> create_version_table(SqlDatabase& database);
/// To be called in a transaction: a rename takes two statements.
SqlResult<void> store_version(SqlDatabase& database, const VersionChange& change);
/// The versions up to a record, by name; a row that is damaged is left out. None if there is no
/// table.
SqlResult<std::vector<NamedVersion>> read_versions(SqlDatabase& database, std::uint64_t last);

}  // namespace kerf
