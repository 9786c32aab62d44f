// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <string>

#include "server/store/journal_error.h"
#include "server/store/sqlite.h"

namespace kerf {

/// The session from a point of which another one began.
struct JournalParent {
  std::string session;           ///< empty: it began with a scene
  std::uint64_t record = 0;      ///< the last one that both have
  std::uint32_t epoch = 0;       ///< of the parent then
  std::int64_t branched_ms = 0;  ///< ms since 1970, UTC
};

/// Creates the journal of a session that begins as a copy of another one up to a record: with its
/// scene, its records, so that the strokes in them stay, its participants and the lists up to it,
/// but without the tokens of its agents. Reads the other journal beside its writer, in one pass.
/// The record must be committed. Takes the space of the copy once; `to` is there when all of it is
/// on the disk, and a process that is killed leaves a file of another name, is_unfinished_branch().
/// Fails with kExists if `to` exists; what it has written is deleted after an error.
std::expected<void, JournalError> branch_journal(const std::filesystem::path& from,
                                                 const std::filesystem::path& to,
                                                 const std::string& session,
                                                 const JournalParent& parent);

/// Whether a file is what branch_journal() writes before it is done. The next one to the same file
/// replaces it.
bool is_unfinished_branch(const std::filesystem::path& file);

/// Reads the parent that a journal states. A row that is damaged counts as none.
SqlResult<JournalParent> read_parent(SqlDatabase& database);

}  // namespace kerf
