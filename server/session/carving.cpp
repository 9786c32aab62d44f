// SPDX-License-Identifier: Apache-2.0
#include "server/session/carving.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "kernel/dexel/dexel_field.h"
#include "kernel/motion_reach.h"
#include "kernel/sculpture_check.h"
#include "server/rights/rights.h"

namespace kerf {

namespace {

/// Interval between two checks whether a tool is clear of returned stock. A check costs as much as
/// a motion.
constexpr std::uint64_t kInStockUs = 10'000;

}  // namespace

Carving::Carving(const SessionLimits& limits, Sculpture& sculpture, SessionJournal& journal,
                 Participants& participants)
    : limits_(limits),
      sculpture_(sculpture),
      journal_(journal),
      participants_(participants),
      air_(sculpture.settings()),
      reserved_(sculpture.settings()) {
  const auto& obstacles = sculpture.settings().obstacles;
  if (!obstacles.empty()) obstacles_.emplace(obstacles);
}

/// A stroke begins with the first motion after the tool was lifted.
std::expected<void, Rejection> Carving::record(ParticipantId id, const Command& command,
                                               std::uint64_t agent_sequence) {
  if (auto ok = sculpture_.check(command); !ok) return std::unexpected(to_rejection(ok.error()));
  ParticipantState* state = participants_.find(id);
  const bool begins_stroke = state != nullptr && !state->in_stroke;
  if (auto ok =
          journal_.append(id, recorded(command), {agent_sequence, begins_stroke, program_line_});
      !ok)
    return ok;
  if (state != nullptr) state->in_stroke = true;
  if (since_) collect(command);
  return {};
}

void Carving::collect(const Command& command) {
  const auto* move = std::get_if<MoveTool>(&command);
  if (move == nullptr) return;
  Since since{{sculpture_.tool(move->tool), *move}, {}};
  std::vector<DexelGrid> grids;
  for (const RayAxis axis : axes_of(sculpture_.settings().rays)) {
    grids.push_back(sculpture_.field(axis)->grid());
  }
  find_reach(*since.motion.tool, *move, grids, sculpture_.settings().tolerance_mm, since.reach);
  if (!since.reach.empty()) since_->push_back(std::move(since));
}

void Carving::begin_collecting() {
  since_.emplace();
  for (const auto& [id, cut] : cuts_) collect(cut.move);
}

double Carving::replace(const TileReplacement& tile) {
  std::vector<MotionSince> motions;
  if (since_) {
    for (const Since& since : *since_) {
      if (std::ranges::binary_search(since.reach, tile.at)) motions.push_back(since.motion);
    }
  }
  const ReplacedTiles replaced = sculpture_.replace({&tile, 1}, motions);
  changed_.insert(replaced.changed_tiles.begin(), replaced.changed_tiles.end());
  participants_.note_returned(replaced.tiles);
  return replaced.returned_mm3;
}

std::optional<Rejection> Carving::judge(ParticipantId id, const MoveTool& move) const {
  const ParticipantState* state = participants_.find(id);
  const Tool* tool = sculpture_.tool(move.tool);
  if (state == nullptr || tool == nullptr) return std::nullopt;
  const Participant& participant = state->participant;
  if (!may(participant.role, Action::kCarve)) {
    return Rejection{wire::ErrorCode::kNotAllowed,
                     "a " + std::string(to_string(participant.role)) + " may not carve"};
  }
  if (participant.is_muted) return muted_rejection();
  return reserved_.judge(*state, move, *tool);
}

Carving::Applied Carving::apply(ParticipantId id, const MoveTool& move, std::int64_t& tiles,
                                std::uint64_t agent_sequence) {
  if (auto ok = admit(id, move, agent_sequence); !ok) return std::unexpected(ok.error());
  return cut_recorded(id, move, tiles);
}

Carving::Applied Carving::cut_recorded(ParticipantId id, const MoveTool& move,
                                       std::int64_t& tiles) {
  const std::int64_t reach = sculpture_.tiles_in_reach(move);
  if (reach > kTilesPerTurn) {
    auto pieces = sculpture_.begin(move);
    if (!pieces) return std::unexpected(to_rejection(pieces.error()));
    // Invalidates the hashes of earlier records.
    journal_.note_removal();
    cuts_.emplace(id, Cut{move, *std::move(pieces), journal_.sequence()});
    return advance(id, tiles);
  }
  tiles -= reach;
  return apply_recorded(id, move);
}

std::expected<void, Rejection> Carving::admit(ParticipantId id, const MoveTool& move,
                                              std::uint64_t agent_sequence) {
  if (auto rejection = judge(id, move)) return std::unexpected(*std::move(rejection));
  return record(id, move, agent_sequence);
}

Carving::Applied Carving::apply_recorded(ParticipantId id, const Command& command) {
  const auto start = Clock::now();
  auto result = sculpture_.apply(command);
  work_time_ += Clock::now() - start;
  if (!result) return std::unexpected(to_rejection(result.error()));
  note(id, *result);
  return *std::move(result);
}

std::expected<void, Rejection> Carving::follow(ParticipantId id, Command command) {
  if (auto* move = std::get_if<MoveTool>(&command)) move->feel = false;
  if (since_) collect(command);
  if (const auto applied = apply_recorded(id, command); !applied) {
    return std::unexpected(applied.error());
  }
  return {};
}

std::optional<MotionResult> Carving::advance(ParticipantId id, std::int64_t& tiles) {
  if (tiles <= 0) return std::nullopt;
  const auto start = Clock::now();
  auto result = sculpture_.advance(cuts_.at(id).pieces, tiles);
  work_time_ += Clock::now() - start;
  tiles = 0;
  if (!result) return std::nullopt;
  cuts_.erase(id);
  note(id, *result);
  return result;
}

void Carving::note(ParticipantId id, const MotionResult& result) {
  motions_applied_.fetch_add(1, std::memory_order_relaxed);
  changed_.insert(result.changed_tiles.begin(), result.changed_tiles.end());
  participants_.note_cut(id, result.cut_tiles);
  // Do not use `changed_tiles`: rays along X and Y may be shortened where the displayed rays, those
  // along Z, are not.
  if (result.removed_mm3 > 0) journal_.note_removal();
}

std::expected<std::optional<MoveTool>, Rejection> Carving::read_sample(
    ParticipantState& state, const wire::MotionSample& sample, Batch& batch) {
  if (sample.agent_sequence <= state.last_sequence) {  // a resent sample
    // The next new motion begins here. The sample was validated when it first came.
    if (state.has_resumed) {
      state.newest_us = sample.time_us;
      (void)state.track.take(sample, sculpture_, state.speed_mm_per_s);
      state.in_stroke = state.in_stroke && cuts(sample);
    }
    return std::nullopt;
  }
  state.has_resumed = false;
  state.last_sequence = sample.agent_sequence;
  state.newest_us = sample.time_us;
  state.cuts = false;
  if (!state.samples.allow(Clock::now())) {
    state.track.lift();  // leaves a gap: a chord across the dropped samples would gouge the block
    return std::unexpected(
        sample_rejection(sample, wire::ErrorCode::kTooFast,
                         "the sample rate limit is " +
                             std::to_string(std::llround(limits_.samples_per_s)) + " per second"));
  }
  if (!cuts(sample) || !state.track.pose()) state.in_stroke = false;
  auto step = state.track.take(sample, sculpture_, state.speed_mm_per_s);
  if (!step) return std::unexpected(step.error());
  if (state.is_in_stock) {
    if (auto rejection = leave_stock(state, sample)) return std::unexpected(*std::move(rejection));
    return std::nullopt;
  }
  state.display.tool_id = sample.tool_id;
  if (state.feel) add_rest(batch.sum, sculpture_, *step, state.held);
  if (const auto* touch = std::get_if<ToolTrack::Touch>(&*step); touch != nullptr && state.feel) {
    add_touch(batch.sum, sculpture_, *touch);
  }
  auto* move = std::get_if<MoveTool>(&*step);
  if (move == nullptr) return std::nullopt;
  move->feel = state.feel;
  return *move;
}

std::optional<Rejection> Carving::take_sample(ParticipantState& state,
                                              const wire::MotionSample& sample, Batch& batch,
                                              std::int64_t& tiles) {
  const auto move = read_sample(state, sample, batch);
  if (!move) return move.error();
  if (!*move) return std::nullopt;
  const std::uint64_t before = journal_.sequence();
  const auto result = apply(state.participant.id, **move, tiles, sample.agent_sequence);
  if (journal_.sequence() != before) state.durable.journaled(journal_.sequence());
  if (!result) return sample_rejection(sample, result.error().code, result.error().reason);
  state.cuts = true;
  if (*result) add_motion(batch.sum, sculpture_, **move, **result, state.held);
  return std::nullopt;
}

/// Rejects motions of a tool that returned stock surrounds, until it is clear. It neither cuts nor
/// is pushed.
std::optional<Rejection> Carving::leave_stock(ParticipantState& state,
                                              const wire::MotionSample& sample) {
  state.in_stroke = false;
  if (state.newest_us - state.in_stock_us >= kInStockUs) {
    state.in_stock_us = state.newest_us;
    state.is_in_stock = sculpture_.is_in_stock(state.track.tool(), *state.track.pose());
  }
  if (!cuts(sample)) return std::nullopt;
  if (!state.is_in_stock) {  // the motion out of the stock is only cut in the agent's replica
    if (state.stock) state.stock->reset();
    return std::nullopt;
  }
  return sample_rejection(sample, wire::ErrorCode::kInStock,
                          "stock has come back around the tool: lift the tool out of it");
}

/// Works on a batch for one turn. Returns true once it is complete.
bool Carving::work(ParticipantState& state, Batch& batch) {
  std::int64_t tiles = kTilesPerTurn;
  if (const auto cut = cuts_.find(state.participant.id); cut != cuts_.end()) {
    const MoveTool move = cut->second.move;
    const auto result = advance(state.participant.id, tiles);
    if (!result) return false;
    add_motion(batch.sum, sculpture_, move, *result, state.held);
  }
  while (batch.next < batch.samples.size()) {
    if (tiles <= 0) return false;
    const wire::MotionSample& sample = batch.samples[batch.next++];
    if (auto rejection = take_sample(state, sample, batch, tiles)) {
      batch.answer.rejections.push_back(*rejection);
    }
    if (cuts_.contains(state.participant.id)) return false;
  }
  return true;
}

MotionAnswer Carving::answer(ParticipantState& state, Batch& batch) {
  MotionAnswer answer = std::move(batch.answer);
  // The agent's replica has already applied the rejected sample: resynchronize it.
  if (!answer.rejections.empty() && state.stock) state.stock->reset();
  wire::Result& result = answer.result;
  result.agent_sequence = state.last_sequence;
  state.durable.handled(state.last_sequence);
  state.durable.committed(journal_.is_fenced() ? 0 : journal_.durable_sequence());
  result.agent_time_us =
      batch.samples.empty() ? state.track.time_us() : batch.samples.back().time_us;
  result.motions_applied = sculpture_.motions();
  batch.sum.write(result);
  if (!answer.rejections.empty()) result.status |= wire::kStatusRejected;
  state.update_display(result, batch.sum);
  if (!batch.samples.empty()) state.note_felt(batch.samples.back());
  answer.felt = participants_.felt_by(state);
  return answer;
}

std::optional<MotionAnswer> Carving::move(ParticipantState& state,
                                          std::span<const wire::MotionSample> samples) {
  const CpuCosts::Meter meter(costs_, state.participant.id);
  Batch batch{.samples = samples};
  if (work(state, batch)) return answer(state, batch);
  batch.kept.assign(samples.begin(), samples.end());
  batch.samples = batch.kept;
  batches_.emplace(state.participant.id, std::move(batch));
  return std::nullopt;
}

void Carving::leave(ParticipantId id) {
  batches_.erase(id);
  std::erase(waiting_, id);
  if (cuts_.contains(id)) left_.push_back(id);
}

bool Carving::finish_left() {
  if (left_.empty()) return false;
  std::int64_t tiles = kTilesPerTurn;
  const ParticipantId id = left_.back();
  // The participant may have returned and completed the motion, or may complete it with a batch.
  if (batches_.contains(id) || !cuts_.contains(id) || advance(id, tiles)) left_.pop_back();
  return !left_.empty();
}

std::vector<TileIndex> Carving::take_changed() {
  const std::set<TileIndex> changed = std::exchange(changed_, {});
  return {changed.begin(), changed.end()};
}

}  // namespace kerf
