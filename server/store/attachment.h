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

/// What belongs to a session and is no record of it, as its rights: the server that continues the
/// session needs it. The kind says who reads the bytes.
struct Attachment {
  std::string kind, name;  ///< together they name it in its session
  std::vector<std::byte> bytes;
};

/// An attachment that is stored, instead of the one of that name, or removed.
struct AttachmentChange {
  std::string kind;  ///< empty: all attachments are removed
  std::string name;
  std::optional<std::vector<std::byte>> bytes = {};  ///< nothing: it is removed
};

/// Creates the tables unless they are there.
SqlResult<void> create_attachment_table(SqlDatabase& database);
/// The greatest number of a row; 0: there is none.
SqlResult<std::int64_t> last_attachment(SqlDatabase& database);
/// `number` is that of the new row, greater than that of any before.
SqlResult<void> store_attachment(SqlDatabase& database, const AttachmentChange& change,
                                 std::int64_t number);

/// The attachments of a journal in the order in which they were stored, as committed; one whose row
/// is damaged is left out. None if there is no table.
std::expected<std::vector<Attachment>, JournalError> read_attachments(
    const std::filesystem::path& journal);
/// The number of attachments whose rows are damaged.
SqlResult<std::int64_t> damaged_attachments(SqlDatabase& database);
/// The lines of the programs' newest motions in a journal, by participant, as committed.
std::expected<std::map<ParticipantId, std::uint32_t>, JournalError> read_program_lines(
    const std::filesystem::path& journal);
/// Removes all attachments, and what of them the file may still hold. Nobody else may have it open.
std::expected<void, JournalError> remove_attachments(const std::filesystem::path& journal);

}  // namespace kerf
