// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/store/journal_error.h"
#include "server/store/sqlite.h"

namespace kerf {

/// How much of a journal a copy has, and which journal it is.
struct CopyPosition {
  std::uint64_t record = 0;      ///< last record of the copy; 0 if none
  std::uint64_t hash_after = 0;  ///< record of its newest state hash; 0 if none
  std::uint32_t scene_crc = 0;   ///< checksum of the scene; 0 if the copy is empty
  std::uint32_t record_crc = 0;  ///< checksum of the row with the last record
  friend bool operator==(const CopyPosition&, const CopyPosition&) = default;
};

/// Committed rows of a journal for a copy of it.
struct JournalChange {
  CopyPosition before, after;
  /// The copy then equals the journal after some commit. Otherwise the next change has more rows of
  /// the same commits.
  bool is_whole = true;
  std::vector<std::byte> rows;
};

/// Size of batches and attachments at which a change ends, bytes.
inline constexpr std::size_t kChangeBytes = std::size_t{4} << 20;

/// Reads the rows committed to a journal since the last call. Runs on another thread than the
/// writer, in parallel with it. Keeps the file open only while it reads. Remembers the rows of
/// small tables, but not the records.
class JournalChanges {
 public:
  explicit JournalChanges(std::filesystem::path file) : file_(std::move(file)) {}

  /// Continues a copy at `position`. Returns false if the journal lacks the copy's records: the
  /// copy is of another journal or further ahead.
  std::expected<bool, JournalError> begin(const CopyPosition& position);
  /// Returns the rows committed since the last call: all of at least one commit, unless they exceed
  /// kChangeBytes. Nullopt if there are none. The first call returns all rows of the small tables.
  std::expected<std::optional<JournalChange>, JournalError> next();
  const CopyPosition& position() const { return position_; }

 private:
  std::expected<std::optional<JournalChange>, JournalError> read(SqlDatabase& database);

  std::filesystem::path file_;
  CopyPosition position_;
  bool is_first_ = true;
  /// The rows of small tables in the copy, by table and key.
  std::map<std::string, std::vector<std::byte>> sent_;
  /// The numbers of fixed rows in the copy, by table.
  std::map<std::uint8_t, std::set<std::int64_t>> fixed_;
};

/// Returns the position of a complete copy of a journal.
std::expected<CopyPosition, JournalError> end_of_journal(const std::filesystem::path& file);

/// Returns the epoch in which a session's server wrote this journal. 0 if the file was made from
/// changes: it may then lack newer lists and attachments that the shared copy has.
std::expected<std::uint32_t, JournalError> epoch_written(const std::filesystem::path& file);

/// Writes changes to a copy of a journal. The file gets its name only when it is complete.
class JournalCopy {
 public:
  /// Begins an empty copy. Fails with kExists if the file exists.
  static std::expected<JournalCopy, JournalError> create(const std::filesystem::path& file);
  /// Continues a finished copy that ends at `position`. The file, and its readers, then get each
  /// whole change. finish() is not called.
  static std::expected<JournalCopy, JournalError> resume(const std::filesystem::path& file,
                                                         const CopyPosition& position);
  JournalCopy(JournalCopy&&) noexcept = default;
  JournalCopy& operator=(JournalCopy&&) noexcept = default;
  /// Removes the copy unless it was finished.
  ~JournalCopy();

  /// Writes the rows of a change. kCorrupt if they are malformed or do not follow those written. A
  /// change that follows the last whole one replaces the ones written since.
  std::expected<void, JournalError> apply(const JournalChange& change);
  /// Drops changes after the last whole one, verifies each record, and gives the file its name.
  /// kCorrupt if no change was whole or a record is bad.
  std::expected<CopyPosition, JournalError> finish();
  /// The position after the last whole change; nullopt if there was none.
  const std::optional<CopyPosition>& whole() const { return whole_; }
  /// Whether a list that people keep with the block has changed since the last call.
  bool take_changed_lists() { return std::exchange(lists_changed_, false); }
  /// Whether the attachments have changed since the last call.
  bool take_changed_attachments() { return std::exchange(attachments_changed_, false); }

 private:
  JournalCopy(std::filesystem::path file, std::filesystem::path unfinished, SqlDatabase database);
  JournalError corrupt(std::string reason) const;

  std::filesystem::path file_, unfinished_;  ///< the second is empty once the file is finished
  std::optional<SqlDatabase> database_;
  CopyPosition position_;  ///< after the last change
  std::optional<CopyPosition> whole_;
  bool lists_changed_ = false, attachments_changed_ = false;
};

}  // namespace kerf
