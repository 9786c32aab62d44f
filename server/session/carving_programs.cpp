// SPDX-License-Identifier: Apache-2.0
// The part of Carving for the motions of programs.
#include <utility>

#include "server/session/carving.h"
#include "server/verify/obstacle_push.h"

namespace kerf {
namespace {

/// Work of one turn in the search of a motion, in distance computations: about 0.3 ms.
constexpr std::size_t kDistancesPerTurn = 300;
/// Maximum number of poses along a motion that are checked against obstacles: about 0.3 ms.
constexpr int kObstaclePlacesMax = 200;

}  // namespace

/// Ends the stroke at a tool change and at the first rapid clear of the stock, so that undo takes
/// back one pass of a program instead of all of it.
void Carving::end_stroke(const ProgramStep& step, const MoveTool& move, const Tool& tool) {
  ParticipantState* state = participants_.find(step.participant);
  if (state == nullptr) return;
  const bool changes_tool = state->participant.tool != move.tool;
  const bool is_clear = step.motion.rapid && air_.is_clear(move, tool);
  if (changes_tool || (is_clear && !state->in_air)) state->in_stroke = false;
  state->in_air = is_clear;
}

std::expected<void, Rejection> Carving::apply_air(ParticipantId id) {
  const auto found = air_paths_.find(id);
  if (found == air_paths_.end() || !found->second.joined()) return {};
  // A motion that meets no stock is cheap, however many tiles it crosses.
  const Command command = *found->second.joined();
  if (auto ok = record(id, command); !ok) return ok;
  if (auto done = apply_recorded(id, command); !done) return std::unexpected(done.error());
  found->second.clear();
  return {};
}

Carving::Applied Carving::apply_or_join(const ProgramStep& step, std::int64_t& tiles) {
  const ParticipantId id = step.participant;
  const CpuCosts::Meter meter(costs_, id);
  const ProgramMotion& motion = step.motion;
  const MoveTool move{motion.tool, motion.from, motion.to, motion.duration_s, step.feel};
  const Tool* tool = sculpture_.tool(move.tool);
  if (tool != nullptr) end_stroke(step, move, *tool);
  const bool joinable = !step.is_last && tool != nullptr && air_.contains(move, *tool);
  if (joinable) {
    if (auto ok = sculpture_.check(move); !ok) return std::unexpected(to_rejection(ok.error()));
    if (air_paths_[id].add(move)) return MotionResult{};
  }
  if (auto ok = apply_air(id); !ok) return std::unexpected(ok.error());
  if (!joinable) return apply(id, move, tiles);
  air_paths_[id].add(move);
  return MotionResult{};
}

void Carving::end_program(ParticipantId id) {
  // If the journal is paused, the last air moves of a cancelled program are lost.
  (void)apply_air(id);
  air_paths_.erase(id);
  searched_.erase(id);
}

void Carving::show_step(const ProgramStep& step, const MotionResult& done) {
  ParticipantState* state = participants_.find(step.participant);
  if (state == nullptr) return;
  const ProgramMotion& motion = step.motion;
  const bool tool_changed = std::exchange(state->participant.tool, motion.tool) != motion.tool;
  state->display.tool_id = motion.tool;
  state->track.place(motion.to);
  BatchSum sum;
  sum.add(done, motion.duration_s);
  wire::Result display;
  sum.write(display);
  state->update_display(display, sum);
  if (tool_changed) participants_.note_tool_change();
}

void Carving::show(ParticipantId id, const ToolPose& pose) {
  ParticipantState* state = participants_.find(id);
  if (state != nullptr) state->show_at(pose);
}

CarvedMotion Carving::carved_of(const ProgramStep& step, const MotionResult& done) const {
  CarvedMotion carved{.removed_mm3 = done.removed_mm3,
                      .stock_contact_mm = done.stock_contact_mm,
                      .cutting_n = length(done.wrench.force_n - done.collision.force_n)};
  if (step.feel && obstacles_) {
    carved.collision_n =
        greatest_push_n(*obstacles_, *sculpture_.tool(step.motion.tool), step.motion,
                        sculpture_.settings().force.pivot_mm, kObstaclePlacesMax);
  }
  return carved;
}

/// Whether a motion is searched once it has cut: for gouges, or, as a rapid, for its depth.
bool Carving::is_searched(const ProgramStep& step) const {
  if (step.target != nullptr) return true;
  const ProgramMotion& motion = step.motion;
  const Tool* tool = sculpture_.tool(motion.tool);
  return motion.rapid && tool != nullptr &&
         !air_.is_clear({motion.tool, motion.from, motion.to, motion.duration_s, false}, *tool);
}

/// Begins the search of a motion that has cut, in the stock before and after it. So a rapid through
/// the air is not measured, whether or not the program has a target.
void Carving::begin_search(const ProgramStep& step, const MotionResult& done, Searched& search) {
  const ProgramMotion& motion = step.motion;
  const DexelSnapshot after = sculpture_.snapshot();
  if (motion.rapid) {
    search.depth.emplace(*sculpture_.tool(motion.tool), motion.from, motion.to,
                         sculpture_.settings().tolerance_mm, *search.before, after, done.cut_tiles);
  }
  if (step.target != nullptr)
    search.gouges.emplace(*step.target, *search.before, after, done.cut_tiles);
  search.before.reset();
}

/// Searches a completed motion of a program; nullopt while the search is unfinished.
std::optional<CarvedMotion> Carving::search_on(ParticipantId id) {
  const CpuCosts::Meter meter(costs_, id);
  const auto found = searched_.find(id);
  Searched& search = found->second;
  if (search.depth && !search.depth->advance(kDistancesPerTurn)) return std::nullopt;
  if (search.gouges && !search.gouges->advance(kDistancesPerTurn)) return std::nullopt;
  CarvedMotion carved = std::move(search.carved);
  if (search.depth) carved.depth_mm = search.depth->depth_mm();
  if (search.gouges) carved.gouge = search.gouges->deepest();
  searched_.erase(found);
  return carved;
}

std::expected<std::optional<CarvedMotion>, Rejection> Carving::move(const ProgramStep& step) {
  const ParticipantId id = step.participant;
  const auto searched = searched_.find(id);
  if (searched != searched_.end() && searched->second.has_begun()) return search_on(id);
  std::int64_t tiles = kTilesPerTurn;
  Applied result;
  if (cuts_.contains(id)) {
    result = advance(id, tiles);
  } else if (auto ok = journal_.check_space_for_programs(); !ok) {
    return std::unexpected(ok.error());
  } else {
    if (is_searched(step)) searched_[id].before = sculpture_.snapshot();
    program_line_ = step.motion.line;
    result = apply_or_join(step, tiles);
    program_line_ = 0;
  }
  if (!result) return std::unexpected(result.error());
  if (!*result) return std::nullopt;
  const MotionResult& done = **result;
  show_step(step, done);
  CarvedMotion carved = carved_of(step, done);
  const auto search = searched_.find(id);
  if (search == searched_.end()) return carved;
  if (done.cut_tiles.empty()) {
    searched_.erase(search);
    return carved;
  }
  search->second.carved = std::move(carved);
  begin_search(step, done, search->second);
  return search_on(id);
}

}  // namespace kerf
