// SPDX-License-Identifier: Apache-2.0
// The part of Carving that carves batches of several participants together.
#include <algorithm>
#include <utility>

#include "kernel/cut/workers.h"
#include "server/session/carving.h"

namespace kerf {

void Carving::wait(ParticipantState& state, std::span<const wire::MotionSample> samples) {
  Batch& batch = batches_[state.participant.id];
  batch.kept.assign(samples.begin(), samples.end());
  batch.samples = batch.kept;
  batch.waits = true;
  waiting_.push_back(state.participant.id);
}

std::optional<MotionAnswer> Carving::go_on(ParticipantState& state, Workers& workers) {
  const auto found = batches_.find(state.participant.id);
  if (found == batches_.end()) return std::nullopt;
  Batch& batch = found->second;
  if (batch.waits) {
    carve_waiting(workers);
  } else if (!batch.is_complete) {
    const CpuCosts::Meter meter(costs_, state.participant.id);
    if (!work(state, batch)) return std::nullopt;
    batch.answer = answer(state, batch);
    batch.is_complete = true;
  }
  if (!batch.is_complete) return std::nullopt;
  MotionAnswer complete = std::move(batch.answer);
  batches_.erase(found);
  return complete;
}

/// Carves the queued batches for one turn: as much work as all workers do in one participant's
/// turn.
void Carving::carve_waiting(Workers& workers) {
  std::int64_t tiles = kTilesPerTurn * workers.count();
  while (tiles > 0 && !waiting_.empty()) {
    const double start_s = Clock::thread_cpu_s();
    Together round;
    collect_round(round, tiles);
    apply_together(round, workers);
    const double share_s = (Clock::thread_cpu_s() - start_s) /
                           static_cast<double>(std::max<std::size_t>(1, round.of.size()));
    for (const Recorded& motion : round.of) costs_.add(motion.state->participant.id, share_s);
    if (round.last) {
      // One thread cuts it while the other threads wait.
      std::int64_t alone = std::max<std::int64_t>(1, tiles / workers.count());
      tiles -= workers.count() * alone;
      begin_pieces(round.last->first, round.last->second, alone);
    }
    std::erase_if(waiting_, [this](ParticipantId id) {
      const auto found = batches_.find(id);
      ParticipantState* state = participants_.find(id);
      if (found == batches_.end() || state == nullptr || !found->second.waits) return true;
      Batch& batch = found->second;
      if (batch.next < batch.samples.size()) return false;
      batch.answer = answer(*state, batch);
      batch.is_complete = true;
      batch.waits = false;
      return true;
    });
  }
}

/// Collects samples of the queued batches, one of each in turn, until there is work for this turn.
/// A sample that is no motion ends the round for its batch: it touches the stock left by its
/// batch's earlier motions, or keeps their force. Motions of other batches in the round may stay
/// invisible to it.
void Carving::collect_round(Together& round, std::int64_t& tiles) {
  std::vector<ParticipantId> left = waiting_;
  while (!left.empty()) {
    std::vector<ParticipantId> next;
    for (const ParticipantId id : left) {
      if (tiles <= 0 || round.last) return;
      const auto found = batches_.find(id);
      ParticipantState* state = participants_.find(id);
      if (found == batches_.end() || state == nullptr || !found->second.waits) continue;
      Batch& batch = found->second;
      if (batch.next == batch.samples.size()) continue;
      const bool has_moved =
          std::ranges::find(round.of, &batch, &Recorded::batch) != round.of.end();
      if (has_moved && !state->track.would_move(batch.samples[batch.next])) continue;
      take_next(*state, batch, round, tiles);
      next.push_back(id);
    }
    left = std::move(next);
  }
}

void Carving::take_next(ParticipantState& state, Batch& batch, Together& round,
                        std::int64_t& tiles) {
  const wire::MotionSample& sample = batch.samples[batch.next++];
  const ParticipantId id = state.participant.id;
  const auto reject = [&](const Rejection& why) { batch.answer.rejections.push_back(why); };
  const auto move = read_sample(state, sample, batch);
  if (!move) return reject(move.error());
  if (!*move) return;
  if (auto ok = admit(id, **move, sample.agent_sequence); !ok) {
    return reject(sample_rejection(sample, ok.error().code, ok.error().reason));
  }
  state.durable.journaled(journal_.sequence());
  state.cuts = true;
  const std::int64_t reach = sculpture_.tiles_in_reach(**move);
  if (reach > kTilesPerTurn) {
    // A large motion is cut in pieces, in its own turns, after the motions before it in the
    // journal.
    batch.waits = false;
    round.last = {{&state, &batch}, **move};
    return;
  }
  tiles -= reach;
  round.moves.push_back(**move);
  round.of.push_back({&state, &batch});
}

/// Begins to cut a motion in pieces. go_on() continues it and the rest of its batch.
void Carving::begin_pieces(const Recorded& of, const MoveTool& move, std::int64_t& tiles) {
  const CpuCosts::Meter meter(costs_, of.state->participant.id);
  const auto result = cut_recorded(of.state->participant.id, move, tiles);
  if (result && *result) add_motion(of.batch->sum, sculpture_, move, **result, of.state->held);
}

void Carving::apply_together(const Together& round, Workers& workers) {
  if (round.moves.empty()) return;
  const auto start = Clock::now();
  SerialWorkers alone;
  Workers& used = round.moves.size() > 1 ? workers : alone;
  sculpture_.apply(round.moves, used, [&](std::size_t n, const MotionResult& result) {
    const auto [state, batch] = round.of[n];
    note(state->participant.id, result);
    add_motion(batch->sum, sculpture_, round.moves[n], result, state->held);
  });
  // A replay uses one thread.
  work_time_ += used.count() * (Clock::now() - start);
}

}  // namespace kerf
