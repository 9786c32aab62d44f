// SPDX-License-Identifier: Apache-2.0
#include "server/history/stroke_table.h"

#include <algorithm>

namespace kerf {

void StrokeTable::add(const JournalRecord& record) {
  last_ = record.sequence;
  if (const auto* change = std::get_if<StrokeChange>(&record.command)) {
    changes_.push_back({record.sequence, *change});
    return;
  }
  const auto* move = std::get_if<MoveTool>(&record.command);
  if (move == nullptr) return;
  if (record.stroke == record.sequence) {
    of_participant_[record.participant].push_back(record.sequence);
    strokes_.push_back({.id = record.sequence,
                        .participant = record.participant,
                        .tool = move->tool,
                        .begin_ms = record.wall_ms});
  }
  const StrokeId id = stroke_of(record.participant, record.sequence);
  if (id == 0) return;
  Stroke& stroke = *std::ranges::lower_bound(strokes_, id, {}, &Stroke::id);
  stroke.last = record.sequence;
  stroke.end_ms = record.wall_ms;
  ++stroke.motions;
}

const Stroke* StrokeTable::find(StrokeId id) const {
  const auto found = std::ranges::lower_bound(strokes_, id, {}, &Stroke::id);
  return found == strokes_.end() || found->id != id ? nullptr : &*found;
}

StrokeId StrokeTable::stroke_of(ParticipantId participant, std::uint64_t record) const {
  const auto found = of_participant_.find(participant);
  if (found == of_participant_.end()) return 0;
  const auto& ids = found->second;
  if (!ids.empty() && ids.back() <= record) return ids.back();
  const auto after = std::ranges::upper_bound(ids, record);
  return after == ids.begin() ? 0 : *std::prev(after);
}

MotionSet StrokeTable::at(std::uint64_t record) const {
  MotionSet set{.last = record};
  for (const auto& [sequence, change] : changes_) {
    if (sequence > record) break;
    if (change.undone) {
      set.without.insert(change.stroke);
    } else {
      set.without.erase(change.stroke);
    }
  }
  return set;
}

StrokeId StrokeTable::newest(ParticipantId participant, std::uint64_t record) const {
  const StrokeSet undone = at(record).without;
  const auto found = std::find_if(strokes_.rbegin(), strokes_.rend(), [&](const Stroke& stroke) {
    return stroke.id <= record && stroke.participant == participant && !undone.contains(stroke.id);
  });
  return found == strokes_.rend() ? 0 : found->id;
}

StrokeId StrokeTable::last_undone(ParticipantId participant, std::uint64_t record) const {
  const StrokeSet undone = at(record).without;
  for (auto change = changes_.rbegin(); change != changes_.rend(); ++change) {
    if (change->record > record) continue;
    const Stroke* stroke = find(change->change.stroke);
    if (stroke != nullptr && stroke->participant == participant && change->change.undone &&
        undone.contains(stroke->id)) {
      return stroke->id;
    }
  }
  return 0;
}

bool StrokeTable::changes_between(std::uint64_t after, std::uint64_t until) const {
  const auto next = std::ranges::upper_bound(changes_, after, {}, &Change::record);
  return next != changes_.end() && next->record <= until;
}

}  // namespace kerf
