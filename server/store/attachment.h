// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/store/journal_error.h"
#include "server/store/journal_record.h"
#include "server/store/sqlite.h"

namespace kerf {

/// Data of a session that is not a record, e.g. its rights. The server that continues the session
/// needs it. `kind` identifies the reader of the bytes.
struct Attachment {
  std::string kind, name;  ///< name of the attachment within its session
  std::vector<std::byte> bytes;
};

/// Stores an attachment, replacing the one with the same name, or removes it.
struct AttachmentChange {
  std::string kind;  ///< if empty, all attachments are removed
  std::string name;
  std::optional<std::vector<std::byte>> bytes = {};  ///< nullopt to remove it
};

/// Creates the tables unless they exist.
SqlResult<void> create_attachment_table(SqlDatabase& database);
/// The greatest row number; 0 if there is no row.
SqlResult<std::int64_t> last_attachment(SqlDatabase& database);
/// `number`: number of the new row, greater than all earlier ones.
SqlResult<void> store_attachment(SqlDatabase& database, const AttachmentChange& change,
                                 std::int64_t number);

/// Returns the committed attachments of a journal in the order in which they were stored, leaving
/// out damaged rows. Empty if there is no table.
std::expected<std::vector<Attachment>, JournalError> read_attachments(
    const std::filesystem::path& journal);
/// Counts the attachments with damaged rows.
SqlResult<std::int64_t> damaged_attachments(SqlDatabase& database);
/// Returns the line of each program's newest committed motion, by participant.
std::expected<std::map<ParticipantId, std::uint32_t>, JournalError> read_program_lines(
    const std::filesystem::path& journal);
/// Removes all attachments, including leftovers of their contents in the file. Nobody else may have
/// the file open.
std::expected<void, JournalError> remove_attachments(const std::filesystem::path& journal);

}  // namespace kerf
