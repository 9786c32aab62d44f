// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "server/merge/journal_merge.h"
#include "server/merge/journal_side.h"
#include "server/store/journal_writer.h"

namespace kerf {

/// A tool and the record that defines it.
struct DefinedTool {
  Tool tool;
  std::uint64_t record = 0;
};

/// Appends the records of one journal to a copy of another, which lacks them.
class StrokeMerger {
 public:
  /// `writer` continues a copy of `ours`. All must outlive this.
  StrokeMerger(const JournalSide& ours, const JournalSide& theirs,
               const std::optional<StrokeSet>& chosen, JournalWriter& writer);

  /// Takes the next record of the other journal, unless it is known. Call with all, in order.
  std::expected<void, JournalError> take(const JournalRecord& record);
  /// Takes the undone and redone strokes and the pins. Call after the last record.
  std::expected<void, JournalError> take_rest();
  const MergedJournal& merged() const { return merged_; }

 private:
  bool is_chosen(StrokeId stroke) const { return !chosen_ || chosen_->contains(stroke); }
  ParticipantId participant_of(ParticipantId theirs);
  std::expected<ToolId, JournalError> tool_of(ToolId theirs);
  std::expected<std::uint64_t, JournalError> append(ParticipantId participant,
                                                    const RecordedCommand& command,
                                                    const RecordOrigin& origin,
                                                    bool begins_stroke = false);
  std::expected<void, JournalError> change(StrokeId stroke, const StrokeMark& mark);
  void take_pins();
  void note_known(StrokeId stroke, ParticipantId participant, std::uint64_t record);

  const JournalSide& ours_;
  const JournalSide& theirs_;
  const std::optional<StrokeSet>& chosen_;
  JournalWriter& writer_;
  std::map<ParticipantId, ParticipantId> participants_;  ///< theirs to ours
  ParticipantId last_participant_ = 0;
  std::map<ToolId, ToolId> tools_;  ///< theirs to ours
  std::map<ToolId, Tool> our_tools_;
  std::map<ToolId, DefinedTool> their_tools_;  ///< as of the newest record
  /// The strokes here that have the motions of one of theirs.
  std::map<StrokeId, std::set<StrokeId>> parts_;
  std::map<std::pair<ParticipantId, StrokeId>, std::size_t> begun_;  ///< index in merged_.strokes
  OriginRow newest_;  ///< of the newest appended record
  std::uint64_t next_clock_;
  MergedJournal merged_;
};

}  // namespace kerf
