// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/store/journal_branch.h"
#include "server/store/list_table.h"

namespace kerf {

/// Name of the list of origins in the journal (kJournalTables).
inline constexpr const char* kOriginsTable = "origins";

/// The identity of a record, which it keeps in every copy of a journal, and its Lamport time: that
/// of a record is greater than those of all records before it in the journal where it was made.
struct RecordOrigin {
  std::string writer;        ///< a random number of each opening of a journal for writing
  std::uint64_t number = 0;  ///< of the record in the journal where it was made
  std::uint64_t clock = 0;
  friend bool operator==(const RecordOrigin&, const RecordOrigin&) = default;
};

/// A row of the list: record `first` has this origin, and the records after it, up to the next row,
/// those that follow.
struct OriginRow {
  std::uint64_t first = 0;
  RecordOrigin origin;
};
ListRow to_row(const OriginRow& row);

/// Returns the row of the records from `first` on that a new writer will make, after records whose
/// Lamport times are less than `clock`.
OriginRow new_writer(std::uint64_t first, std::uint64_t clock);

/// The origins of all records of a journal. The records of a file that stores none have their
/// session as writer, or the session that it was branched from.
class RecordOrigins {
 public:
  /// `rows` are those of the list; `last` is the last record.
  RecordOrigins(const std::string& session, const JournalParent& parent,
                const std::vector<ListRow>& rows, std::uint64_t last);

  /// `record` is in 1 … last.
  RecordOrigin of(std::uint64_t record) const;
  /// Returns the record of an origin; nullopt if the journal has none. The Lamport time is ignored.
  std::optional<std::uint64_t> find(const RecordOrigin& origin) const;
  /// The rows that describe all records, the first one from record 1 on.
  const std::vector<OriginRow>& rows() const { return rows_; }
  /// A Lamport time for the next record.
  std::uint64_t next_clock() const { return next_clock_; }

 private:
  struct Range {
    std::uint64_t number, count, first;
  };
  static void make_disjoint(std::vector<Range>& ranges);

  std::vector<OriginRow> rows_;                          ///< by `first`
  std::map<std::string, std::vector<Range>> of_writer_;  ///< by `number`
  std::uint64_t next_clock_ = 1;
};

}  // namespace kerf
