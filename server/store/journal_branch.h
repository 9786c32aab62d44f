// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <string>

#include "server/store/journal_error.h"
#include "server/store/sqlite.h"

namespace kerf {

/// The parent of a branched session.
struct JournalParent {
  std::string session;           ///< empty if the session began with a scene
  std::uint64_t record = 0;      ///< last record in common
  std::uint32_t epoch = 0;       ///< epoch of the parent at that time
  std::int64_t branched_ms = 0;  ///< ms since 1970, UTC
};

/// Creates the journal of a branch: a copy of another journal up to a committed record, with the
/// scene, the records with their strokes, the participants and the lists up to that record, but
/// without the tokens of agents. Reads the other journal in one pass, in parallel with its writer.
/// Needs the space of one copy. `to` appears only once it is complete on the disk. A killed process
/// leaves a file with a temporary name, see is_unfinished_branch(). Fails with kExists if `to`
/// exists. Deletes its output after an error.
std::expected<void, JournalError> branch_journal(const std::filesystem::path& from,
                                                 const std::filesystem::path& to,
                                                 const std::string& session,
                                                 const JournalParent& parent);

/// Whether a file is an unfinished output of branch_journal(). The next branch to the same file
/// replaces it.
bool is_unfinished_branch(const std::filesystem::path& file);

/// Reads the parent of a journal. A damaged row counts as no parent.
SqlResult<JournalParent> read_parent(SqlDatabase& database);

}  // namespace kerf
