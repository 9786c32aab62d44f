// SPDX-License-Identifier: Apache-2.0
#include "server/merge/stroke_merger.h"

#include <algorithm>

#include "server/session/made_tool.h"

namespace kerf {
namespace {

constexpr const char* kPinsTable = "pins";

const JournalParticipant* find(const std::vector<JournalParticipant>& all, ParticipantId id) {
  const auto found = std::ranges::find(all, id, &JournalParticipant::participant);
  return found == all.end() ? nullptr : &*found;
}

/// Whether two rows of a list are the same except for their number and record.
bool is_same(const ListRow& a, const ListRow& b) {
  return std::ranges::equal(a.begin() + 2, a.end(), b.begin() + 2, b.end());
}

}  // namespace

StrokeMerger::StrokeMerger(const JournalSide& ours, const JournalSide& theirs,
                           const std::optional<StrokeSet>& chosen, JournalWriter& writer)
    : ours_(ours),
      theirs_(theirs),
      chosen_(chosen),
      writer_(writer),
      our_tools_(ours.tools),
      next_clock_(std::max(ours.origins.next_clock(), theirs.origins.next_clock())) {
  for (const JournalParticipant& one : ours.participants) {
    last_participant_ = std::max(last_participant_, one.participant);
  }

  // A participant is the one here who has a record of theirs.
  for (std::uint64_t record = 1; record <= theirs.last(); ++record) {
    const auto& [participant, stroke] = theirs.owners[record - 1];
    if (const auto known = ours.origins.find(theirs.origins.of(record))) {
      note_known(stroke, participant, *known);
    }
  }
}

void StrokeMerger::note_known(StrokeId stroke, ParticipantId participant, std::uint64_t record) {
  const auto& owner = ours_.owners[record - 1];
  participants_.emplace(participant, owner.participant);
  if (stroke != 0 && owner.stroke != 0) parts_[stroke].insert(owner.stroke);
}

/// Returns who someone in the other journal is here, and adds them if they are not.
ParticipantId StrokeMerger::participant_of(ParticipantId theirs) {
  if (theirs == 0) return 0;
  const auto known = participants_.find(theirs);
  if (known != participants_.end()) return known->second;
  const JournalParticipant* one = find(theirs_.participants, theirs);
  const ParticipantId id = ++last_participant_;
  participants_.emplace(theirs, id);
  writer_.append(one == nullptr ? JournalParticipant{id, "", "", "agent"}
                                : JournalParticipant{id, one->name, one->color, one->kind});
  ++merged_.people;
  return id;
}

/// Returns the tool here with the outline of one in the other journal, and defines it if there is
/// none.
std::expected<ToolId, JournalError> StrokeMerger::tool_of(ToolId theirs) {
  const auto known = tools_.find(theirs);
  if (known != tools_.end()) return known->second;
  const auto defined_there = their_tools_.find(theirs);
  if (defined_there == their_tools_.end()) {
    return std::unexpected(JournalError{
        JournalErrorCode::kCorrupt, theirs_.header.session, 0,
        "a motion uses tool " + std::to_string(theirs) + ", which no record before it defines"});
  }
  const auto& [tool, record] = defined_there->second;
  const auto same = our_tools_.find(theirs);
  const bool keeps_number = same != our_tools_.end() && same->second == tool;
  const auto equal = keeps_number ? same : std::ranges::find_if(our_tools_, [&](const auto& one) {
    return one.second == tool;
  });
  if (equal != our_tools_.end()) return tools_[theirs] = equal->first;
  const ToolId id = our_tools_.empty() ? 1 : our_tools_.rbegin()->first + 1;
  const auto defined = append(0, DefineTool{id, tool}, theirs_.origins.of(record));
  if (!defined) return std::unexpected(defined.error());
  our_tools_.emplace(id, tool);
  ++merged_.tools;
  for (const ListRow& row : theirs_.lists.at(kMadeToolsTable)) {
    if (std::get<std::int64_t>(row.at(0)) != std::int64_t{theirs}) continue;
    auto made = made_tool_of(row, theirs_.tolerance_mm);
    if (!made) continue;
    made->id = id;
    made->record = *defined;
    writer_.append(ListChange{.table = kMadeToolsTable, .stored = to_row(*made)});
  }
  return tools_[theirs] = id;
}

std::expected<std::uint64_t, JournalError> StrokeMerger::append(ParticipantId participant,
                                                                const RecordedCommand& command,
                                                                const RecordOrigin& origin,
                                                                bool begins_stroke) {
  const RecordNote note{.begins_stroke = begins_stroke};
  auto record = writer_.append(participant, command, note);
  if (!record && record.error().code == JournalErrorCode::kFull) {
    if (auto ok = writer_.flush(); !ok) return std::unexpected(ok.error());
    record = writer_.append(participant, command, note);
  }
  if (!record) return record;
  const std::uint64_t steps = *record - newest_.first;
  const bool follows = newest_.first != 0 && newest_.origin.writer == origin.writer &&
                       newest_.origin.number + steps == origin.number &&
                       newest_.origin.clock + steps == origin.clock;
  if (!follows) {
    newest_ = {*record, origin};
    writer_.append(ListChange{.table = kOriginsTable, .stored = to_row(newest_)});
  }
  return record;
}

std::expected<void, JournalError> StrokeMerger::take(const JournalRecord& record) {
  if (const auto* defined = std::get_if<DefineTool>(&record.command)) {
    their_tools_.insert_or_assign(defined->id, DefinedTool{defined->tool, record.sequence});
    tools_.erase(defined->id);
  }
  const auto* move = std::get_if<MoveTool>(&record.command);
  if (move == nullptr || !is_chosen(record.stroke)) return {};
  const RecordOrigin origin = theirs_.origins.of(record.sequence);
  if (ours_.origins.find(origin)) return {};
  const auto tool = tool_of(move->tool);
  if (!tool) return std::unexpected(tool.error());
  const ParticipantId participant = participant_of(record.participant);
  const auto [begun, begins] =
      begun_.try_emplace({record.participant, record.stroke}, merged_.strokes.size());
  MoveTool motion = *move;
  motion.tool = *tool;
  const auto appended = append(participant, motion, origin, begins);
  if (!appended) return std::unexpected(appended.error());
  if (begins) {
    const JournalParticipant* author = find(theirs_.participants, record.participant);
    const auto mark = theirs_.marks.find(record.stroke);
    merged_.strokes.push_back({.id = record.stroke,
                               .author = author == nullptr ? "" : author->name,
                               .is_undone = mark != theirs_.marks.end() && mark->second.undone,
                               .begin_ms = record.wall_ms});
    parts_[record.stroke].insert(*appended);
  }
  ++merged_.strokes[begun->second].motions;
  ++merged_.motions;
  return {};
}

/// Repeats the newest change of one of their strokes here, where it is newer than ours.
std::expected<void, JournalError> StrokeMerger::change(StrokeId stroke, const StrokeMark& mark) {
  const auto parts = parts_.find(stroke);
  if (parts == parts_.end()) return {};
  for (const StrokeId part : parts->second) {
    const auto ours = ours_.marks.find(part);
    if (ours != ours_.marks.end() && ours->second >= mark) continue;
    const bool was_undone = ours != ours_.marks.end() && ours->second.undone;
    const auto appended = append(participant_of(mark.author), StrokeChange{part, mark.undone},
                                 {mark.writer, mark.number, mark.clock});
    if (!appended) return std::unexpected(appended.error());
    if (part <= ours_.last() && was_undone != mark.undone) {
      ++(mark.undone ? merged_.undone : merged_.redone);
    }
  }
  return {};
}

void StrokeMerger::take_pins() {
  const auto& ours = ours_.lists.at(kPinsTable);
  std::int64_t last = 0;
  for (const ListRow& row : ours) last = std::max(last, std::get<std::int64_t>(row.at(0)));
  for (ListRow row : theirs_.lists.at(kPinsTable)) {
    if (std::ranges::any_of(ours, [&](const ListRow& one) { return is_same(one, row); })) continue;
    row[0] = ++last;
    row[1] = static_cast<std::int64_t>(writer_.last_sequence());
    writer_.append(ListChange{.table = kPinsTable, .stored = std::move(row)});
    ++merged_.pins;
  }
}

std::expected<void, JournalError> StrokeMerger::take_rest() {
  for (const auto& [stroke, mark] : theirs_.marks) {
    if (!is_chosen(stroke)) continue;
    if (auto ok = change(stroke, mark); !ok) return ok;
  }
  take_pins();
  merged_.last = writer_.last_sequence();
  const auto row = to_row(new_writer(merged_.last + 1, next_clock_));
  writer_.append(ListChange{.table = kOriginsTable, .stored = row});
  return {};
}

}  // namespace kerf
