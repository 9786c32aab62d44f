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

/// How far a copy of a journal goes, and what tells that journal from another one.
struct CopyPosition {
  std::uint64_t record = 0;      ///< the last one that the copy has; 0: none
  std::uint64_t hash_after = 0;  ///< the record of its newest state hash; 0: none
  std::uint32_t scene_crc = 0;   ///< of the session; 0: the copy is empty
  std::uint32_t record_crc = 0;  ///< of the row that holds the last record
  friend bool operator==(const CopyPosition&, const CopyPosition&) = default;
};

/// Rows that have been committed to a journal, for a copy of it.
struct JournalChange {
  CopyPosition before, after;
  /// The copy is then as the journal was after some commit. Otherwise rows of the same commits
  /// follow in the next change.
  bool is_whole = true;
  std::vector<std::byte> rows;
};

/// Bytes of batches, and of attachments, after which a change ends.
inline constexpr std::size_t kChangeBytes = std::size_t{4} << 20;

/// Reads what has been committed to a journal since the last time. Runs beside the writer, on
/// another thread, and holds the file open only while it reads. It remembers the rows of small
/// tables that it has read, not the records.
class JournalChanges {
 public:
  explicit JournalChanges(std::filesystem::path file) : file_(std::move(file)) {}

  /// Continues a copy that another process, or nobody, has begun. False if the journal does not
  /// have what the copy has: the copy is that of another journal, or goes further.
  std::expected<bool, JournalError> begin(const CopyPosition& position);
  /// The rows since the last call, those of at least one commit unless they have kChangeBytes;
  /// nullopt if there are none. The first call returns all rows of the small tables.
  std::expected<std::optional<JournalChange>, JournalError> next();
  const CopyPosition& position() const { return position_; }

 private:
  std::expected<std::optional<JournalChange>, JournalError> read(SqlDatabase& database);

  std::filesystem::path file_;
  CopyPosition position_;
  bool is_first_ = true;
  /// The rows of the small tables that the copy has: by table and key.
  std::map<std::string, std::vector<std::byte>> sent_;
  /// The numbers of the fixed rows that it has: by table.
  std::map<std::uint8_t, std::set<std::int64_t>> fixed_;
};

/// How far a copy goes that has all of a journal.
std::expected<CopyPosition, JournalError> end_of_journal(const std::filesystem::path& file);

/// The epoch in which the server of a session has written this journal; 0: the file was made from
/// changes, and of what is no record it may have less than the copy has by now.
std::expected<std::uint32_t, JournalError> epoch_written(const std::filesystem::path& file);

/// Writes changes into a copy of a journal. The file has its name only when it is complete.
class JournalCopy {
 public:
  /// Begins an empty copy. Fails with kExists if the file exists.
  static std::expected<JournalCopy, JournalError> create(const std::filesystem::path& file);
  /// Goes on with a copy that has been finished and ends at `position`. From then on the file has
  /// each change that is whole, for its readers too; finish() is not called.
  static std::expected<JournalCopy, JournalError> resume(const std::filesystem::path& file,
                                                         const CopyPosition& position);
  JournalCopy(JournalCopy&&) noexcept = default;
  JournalCopy& operator=(JournalCopy&&) noexcept = default;
  /// Removes what has not been finished.
  ~JournalCopy();

  /// Writes the rows of a change; kCorrupt if they are not such rows, or do not follow those that
  /// were written. One that follows the last change that is whole takes the place of those after
  /// it.
  std::expected<void, JournalError> apply(const JournalChange& change);
  /// Leaves out the changes after the last one that is whole, verifies each record, and gives the
  /// file its name. kCorrupt if no change was whole, or a record is bad.
  std::expected<CopyPosition, JournalError> finish();
  /// How far the copy goes with the last change that was whole; nullopt: none was.
  const std::optional<CopyPosition>& whole() const { return whole_; }
  /// Whether the named versions or the pins have changed since the last call.
  bool take_changed_lists() { return std::exchange(lists_changed_, false); }
  /// The same of the attachments.
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
