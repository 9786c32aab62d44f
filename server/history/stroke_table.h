// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "server/store/journal_record.h"

namespace kerf {

/// Names a stroke by its first record.
using StrokeId = std::uint64_t;
using StrokeSet = std::set<StrokeId>;

/// The cuts of one participant between touching down and lifting, or of a program.
struct Stroke {
  StrokeId id = 0;
  ParticipantId participant = 0;
  std::uint64_t last = 0;                 ///< its last record so far
  std::uint64_t motions = 0;              ///< its records
  ToolId tool = 0;                        ///< of its first motion
  std::int64_t begin_ms = 0, end_ms = 0;  ///< ms since 1970, UTC
};

/// A set of motions of a journal: those up to a record, without some strokes.
struct MotionSet {
  std::uint64_t last = std::numeric_limits<std::uint64_t>::max();
  StrokeSet without = {};
};

/// The strokes of a journal, and when each was undone and redone.
class StrokeTable {
 public:
  /// Adds the next record of the journal.
  void add(const JournalRecord& record);
  /// Number of the last record added.
  std::uint64_t last() const { return last_; }
  /// All strokes, in the order in which they began.
  std::span<const Stroke> all() const { return strokes_; }
  /// Returns null if no stroke begins with that record.
  const Stroke* find(StrokeId id) const;
  /// The stroke of a participant's motion, or 0 if it has none, as in journals of version 1.
  StrokeId stroke_of(ParticipantId participant, std::uint64_t record) const;
  /// The set of motions that makes up the block after a record.
  MotionSet at(std::uint64_t record) const;
  /// The newest stroke of a participant begun up to a record and not undone there, or 0 without
  /// one.
  StrokeId newest(ParticipantId participant, std::uint64_t record) const;
  /// The stroke of a participant that was undone last, after a record, or 0 without one.
  StrokeId last_undone(ParticipantId participant, std::uint64_t record) const;
  /// Whether there is a change of strokes in (after, until].
  bool changes_between(std::uint64_t after, std::uint64_t until) const;

 private:
  struct Change {
    std::uint64_t record;
    StrokeChange change;
  };
  std::vector<Stroke> strokes_;
  std::map<ParticipantId, std::vector<StrokeId>> of_participant_;  ///< ascending
  std::vector<Change> changes_;                                    ///< by record
  std::uint64_t last_ = 0;
};

}  // namespace kerf
