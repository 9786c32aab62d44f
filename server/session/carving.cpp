// SPDX-License-Identifier: Apache-2.0
#include "server/session/carving.h"

#include <cmath>
#include <string>
#include <utility>

namespace kerf {

Carving::Carving(const SessionLimits& limits, Sculpture& sculpture, SessionJournal& journal,
                 Participants& participants)
    : limits_(limits),
      sculpture_(sculpture),
      journal_(journal),
      participants_(participants),
      air_(sculpture.settings()) {}

std::expected<MotionResult, Rejection> Carving::apply(ParticipantId id, const MoveTool& move) {
  const Command command = move;
  if (auto ok = sculpture_.check(command); !ok) return std::unexpected(to_rejection(ok.error()));
  if (auto ok = journal_.append(id, command); !ok) return std::unexpected(ok.error());
  auto result = sculpture_.apply(command);
  if (!result) return std::unexpected(to_rejection(result.error()));
  motions_applied_.fetch_add(1, std::memory_order_relaxed);
  changed_.insert(result->changed_tiles.begin(), result->changed_tiles.end());
  participants_.note_cut(id, result->cut_tiles);
  // Not `changed_tiles`: rays along X and Y may be shortened where those along Z, which viewers
  // display, are not.
  if (result->removed_mm3 > 0) journal_.note_removal();
  return *std::move(result);
}

std::optional<Rejection> Carving::take_sample(ParticipantState& state,
                                              const wire::MotionSample& sample, BatchSum& sum) {
  if (sample.agent_sequence <= state.last_sequence) return std::nullopt;  // a resent sample
  state.last_sequence = sample.agent_sequence;
  state.newest_us = sample.time_us;
  if (!state.samples.allow(ParticipantState::Clock::now())) {
    state.track.lift();  // leaves a gap: a chord across the dropped samples would gouge the block
    return sample_rejection(sample, wire::ErrorCode::kTooFast,
                            "the sample rate limit is " +
                                std::to_string(std::llround(limits_.samples_per_s)) +
                                " per second");
  }
  auto step = state.track.take(sample, sculpture_, limits_.speed_mm_per_s);
  if (!step) return step.error();
  state.display.tool_id = sample.tool_id;
  if (const auto* touch = std::get_if<ToolTrack::Touch>(&*step); touch != nullptr && state.feel) {
    add_touch(sum, sculpture_, *touch);
  }
  if (auto* move = std::get_if<MoveTool>(&*step)) {
    move->feel = state.feel;
    const auto result = apply(state.participant.id, *move);
    if (!result) return sample_rejection(sample, result.error().code, result.error().reason);
    add_motion(sum, sculpture_, *move, *result);
  }
  return std::nullopt;
}

MotionAnswer Carving::move(ParticipantState& state, std::span<const wire::MotionSample> samples) {
  MotionAnswer answer;
  BatchSum sum;
  for (const wire::MotionSample& sample : samples) {
    if (auto rejection = take_sample(state, sample, sum)) answer.rejections.push_back(*rejection);
  }
  // The agent's replica has already applied the rejected sample: resynchronize it.
  if (!answer.rejections.empty() && state.stock) state.stock->reset();
  wire::Result& result = answer.result;
  result.agent_sequence = state.last_sequence;
  result.agent_time_us = samples.empty() ? state.track.time_us() : samples.back().time_us;
  result.motions_applied = sculpture_.motions();
  sum.write(result);
  if (!answer.rejections.empty()) result.status |= wire::kStatusRejected;
  state.update_display(result, sum);
  if (!samples.empty()) state.note_felt(samples.back());
  answer.felt = participants_.felt_by(state);
  return answer;
}

std::expected<void, Rejection> Carving::apply_air(ParticipantId id) {
  const auto found = air_paths_.find(id);
  if (found == air_paths_.end() || !found->second.joined()) return {};
  if (auto ok = apply(id, *found->second.joined()); !ok) return std::unexpected(ok.error());
  found->second.clear();
  return {};
}

std::expected<MotionResult, Rejection> Carving::apply_or_join(const ProgramStep& step) {
  const ParticipantId id = step.participant;
  const ProgramMotion& motion = step.motion;
  const MoveTool move{motion.tool, motion.from, motion.to, motion.duration_s, step.feel};
  const Tool* tool = sculpture_.tool(move.tool);
  const bool joinable = !step.is_last && tool != nullptr && air_.contains(move, *tool);
  if (joinable) {
    if (auto ok = sculpture_.check(move); !ok) return std::unexpected(to_rejection(ok.error()));
    if (air_paths_[id].add(move)) return MotionResult{};
  }
  if (auto ok = apply_air(id); !ok) return std::unexpected(ok.error());
  if (!joinable) return apply(id, move);
  air_paths_[id].add(move);
  return MotionResult{};
}

void Carving::end_program(ParticipantId id) {
  // If the journal is paused, the last air moves of a cancelled program are lost.
  (void)apply_air(id);
  air_paths_.erase(id);
}

std::expected<double, Rejection> Carving::move(const ProgramStep& step) {
  if (auto ok = journal_.check_space_for_programs(); !ok) return std::unexpected(ok.error());
  const ProgramMotion& motion = step.motion;
  const auto result = apply_or_join(step);
  if (!result) return std::unexpected(result.error());
  if (ParticipantState* state = participants_.find(step.participant)) {
    const bool tool_changed = std::exchange(state->participant.tool, motion.tool) != motion.tool;
    state->display.tool_id = motion.tool;
    state->track.place(motion.to);
    BatchSum sum;
    sum.add(*result, motion.duration_s);
    wire::Result display;
    sum.write(display);
    state->update_display(display, sum);
    if (tool_changed) participants_.note_tool_change();
  }
  return result->removed_mm3;
}

std::vector<TileIndex> Carving::take_changed() {
  const std::set<TileIndex> changed = std::exchange(changed_, {});
  return {changed.begin(), changed.end()};
}

}  // namespace kerf
