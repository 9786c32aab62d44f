// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <expected>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "kernel/force/collision.h"
#include "kernel/sculpture.h"
#include "server/convert/rejection.h"
#include "server/platform/clock.h"
#include "server/session/air_path.h"
#include "server/session/cpu_costs.h"
#include "server/session/participants.h"
#include "server/session/program_runs.h"
#include "server/session/reserved.h"
#include "server/session/session_journal.h"
#include "server/session/session_limits.h"
#include "server/verify/cut_depth.h"
#include "server/wire/types.h"

namespace kerf {

/// The reply to a batch of samples, for the agent that sent it.
struct MotionAnswer {
  wire::Result result;
  std::vector<Rejection> rejections;    ///< at most one per sample
  std::optional<wire::ToolState> felt;  ///< tool of the participant named by `feel_of`, if present
};

/// Work of one turn of the executor, in tiles of 32 x 32 columns. A motion that reaches more is cut
/// in pieces. A batch that has used up its turn continues in a later one. A tile takes up to 60 us.
inline constexpr std::int64_t kTilesPerTurn = 128;

/// Turns samples and program motions into commands: validates, journals and applies each one, in
/// this order. Runs on the session's executor.
class Carving {
 public:
  /// The references must outlive this.
  Carving(const SessionLimits& limits, Sculpture& sculpture, SessionJournal& journal,
          Participants& participants);

  /// Carves a batch of samples of one participant, which has no other batch in progress. A rejected
  /// sample changes nothing and does not stop the samples after it. Returns nullopt if the batch is
  /// more work than one turn: the caller then repeats go_on() until it returns the answer.
  std::optional<MotionAnswer> move(ParticipantState& state,
                                   std::span<const wire::MotionSample> samples);
  /// Queues the only batch of a participant. The next go_on() carves all queued batches.
  void wait(ParticipantState& state, std::span<const wire::MotionSample> samples);
  /// Carves for another turn. Returns the answer once the batch is complete. Queued batches are
  /// carved together on `workers`: one sample of each in turn, in order of arrival.
  std::optional<MotionAnswer> go_on(ParticipantState& state, Workers& workers);
  /// Whether a batch of the participant is in progress.
  bool has_batch(ParticipantId id) const { return batches_.contains(id); }
  /// Carves one motion of a program, and searches it for gouges if the program has a target and for
  /// its depth if it is a rapid near the stock. Returns nullopt if that is more work than one turn:
  /// repeat the call with the same motion. If a motion takes several turns, cuts by other
  /// participants in its tiles count as its own. Consecutive air motions are joined (air_path.h):
  /// they are applied and journaled with the next motion that does not join them. Fails with kBusy
  /// while the journal has no space for programs.
  std::expected<std::optional<CarvedMotion>, Rejection> move(const ProgramStep& step);
  /// Shows the tool of a program at a pose along the motion to be carved next, with the force of
  /// the motion before it.
  void show(ParticipantId id, const ToolPose& pose);
  /// Ends the program of a participant: applies the motions that are still being joined.
  void end_program(ParticipantId id);

  /// Applies a command from the journal of a followed session, without computing force.
  std::expected<void, Rejection> follow(ParticipantId id, Command command);

  /// Removes a participant and drops the rest of its batch. Its journaled motion must still be
  /// completed: finish_left() does that.
  void leave(ParticipantId id);
  /// Works for one turn on motions of participants that have left. Returns false if there are none.
  bool finish_left();
  /// Whether a motion is partly cut, so that the solid matches no record of the journal.
  bool is_between_records() const { return !cuts_.empty(); }

  /// A motion that was journaled while tiles were being carved without it.
  struct Since {
    MotionSince motion;
    std::vector<FieldTile> reach;  ///< sorted
  };
  /// Collects the motions journaled from now on, and those that are partly cut.
  void begin_collecting();
  void end_collecting() { since_.reset(); }
  std::size_t collected() const { return since_ ? since_->size() : 0; }
  /// Whether a motion of one of the records up to this one is partly cut.
  bool is_cutting(std::uint64_t record) const {
    return std::ranges::any_of(cuts_,
                               [record](const auto& c) { return c.second.record <= record; });
  }
  /// Replaces a tile by its state as of begin_collecting(), then cuts it with the motions collected
  /// since. Returns the volume that came back, mm³.
  double replace(const TileReplacement& tile);

  /// Replaces the reserved regions.
  void reserve(const std::vector<Region>& regions) { reserved_.set(regions); }

  /// Returns the tiles changed since the previous call, sorted.
  std::vector<TileIndex> take_changed();
  /// Time spent applying motions: an upper bound for their replay.
  std::chrono::microseconds work_time() const {
    return std::chrono::duration_cast<std::chrono::microseconds>(work_time_);
  }
  /// CPU time by participant (any thread).
  CpuCosts& costs() { return costs_; }
  const CpuCosts& costs() const { return costs_; }
  /// Motions applied since the server started (any thread).
  std::uint64_t motions_applied() const { return motions_applied_.load(std::memory_order_relaxed); }

 private:
  /// A motion that is cut in pieces.
  struct Cut {
    MoveTool move;
    MotionInPieces pieces;
    std::uint64_t record;
  };
  /// The samples of one participant and their outcome so far.
  struct Batch {
    std::span<const wire::MotionSample> samples;
    std::size_t next = 0;
    BatchSum sum = {};
    MotionAnswer answer = {};
    std::vector<wire::MotionSample> kept = {};  ///< owns the samples from the second turn on
    bool waits = false;                         ///< to be carved together with other batches
    bool is_complete = false;                   ///< `answer` is final
  };
  /// A motion that is in the journal and not yet in the block.
  struct Recorded {
    ParticipantState* state;
    Batch* batch;
  };
  /// Motions of several participants that are applied together, in journal order.
  struct Together {
    std::vector<MoveTool> moves;
    std::vector<Recorded> of;  ///< author of each motion
    /// The motion after them, if it is cut in pieces.
    std::optional<std::pair<Recorded, MoveTool>> last = {};
  };
  using Applied = std::expected<std::optional<MotionResult>, Rejection>;
  /// A motion of a program that is searched for gouges, or for the depth of a rapid.
  struct Searched {
    std::optional<DexelSnapshot> before = {};  ///< the field before it, until it is complete
    CarvedMotion carved = {};
    std::optional<CutDepth> depth = {};
    std::optional<GougeCheck> gouges = {};
    bool has_begun() const { return depth.has_value() || gouges.has_value(); }
  };

  bool work(ParticipantState& state, Batch& batch);
  void carve_waiting(Workers& workers);
  void collect_round(Together& round, std::int64_t& tiles);
  void take_next(ParticipantState& state, Batch& batch, Together& round, std::int64_t& tiles);
  void begin_pieces(const Recorded& of, const MoveTool& move, std::int64_t& tiles);
  void apply_together(const Together& round, Workers& workers);
  MotionAnswer answer(ParticipantState& state, Batch& batch);
  /// Validates a sample. Returns the motion it requests, if any.
  std::expected<std::optional<MoveTool>, Rejection> read_sample(ParticipantState& state,
                                                                const wire::MotionSample& sample,
                                                                Batch& batch);
  std::optional<Rejection> take_sample(ParticipantState& state, const wire::MotionSample& sample,
                                       Batch& batch, std::int64_t& tiles);
  std::optional<Rejection> leave_stock(ParticipantState& state, const wire::MotionSample& sample);
  /// Checks a command of a participant and appends it to the journal.
  std::expected<void, Rejection> record(ParticipantId id, const Command& command,
                                        std::uint64_t agent_sequence = 0);
  void collect(const Command& command);
  Applied apply_recorded(ParticipantId id, const Command& command);
  /// Returns why a participant may not cut there, if so.
  std::optional<Rejection> judge(ParticipantId id, const MoveTool& move) const;
  /// Checks whether a motion may be cut and journals it if so.
  std::expected<void, Rejection> admit(ParticipantId id, const MoveTool& move,
                                       std::uint64_t agent_sequence);
  /// Begins a motion and works on it for at most `tiles`, which is reduced by the work done.
  Applied apply(ParticipantId id, const MoveTool& move, std::int64_t& tiles,
                std::uint64_t agent_sequence = 0);
  /// Like apply(), for a motion that is already in the journal.
  Applied cut_recorded(ParticipantId id, const MoveTool& move, std::int64_t& tiles);
  /// Continues the participant's motion in pieces. Returns the result once it is complete.
  std::optional<MotionResult> advance(ParticipantId id, std::int64_t& tiles);
  void note(ParticipantId id, const MotionResult& result);
  std::expected<void, Rejection> apply_air(ParticipantId id);
  Applied apply_or_join(const ProgramStep& step, std::int64_t& tiles);
  void end_stroke(const ProgramStep& step, const MoveTool& move, const Tool& tool);
  CarvedMotion carved_of(const ProgramStep& step, const MotionResult& done) const;
  bool is_searched(const ProgramStep& step) const;
  void begin_search(const ProgramStep& step, const MotionResult& done, Searched& search);
  void show_step(const ProgramStep& step, const MotionResult& done);
  std::optional<CarvedMotion> search_on(ParticipantId id);

  const SessionLimits& limits_;
  Sculpture& sculpture_;
  SessionJournal& journal_;
  Participants& participants_;
  AirSpace air_;
  std::optional<Obstacles> obstacles_;  ///< set if the scene has any
  Reserved reserved_;
  std::map<ParticipantId, AirPath> air_paths_;  ///< by program
  std::map<ParticipantId, Searched> searched_;  ///< by program
  std::set<TileIndex> changed_;
  std::map<ParticipantId, Batch> batches_;  ///< batches in progress
  std::vector<ParticipantId> waiting_;      ///< with queued batches, in order of arrival
  std::map<ParticipantId, Cut> cuts_;
  std::optional<std::vector<Since>> since_;  ///< set while collecting
  std::uint32_t program_line_ = 0;           ///< program line being recorded; 0 if none
  std::vector<ParticipantId> left_;          ///< left, with cuts that may be in progress
  Clock::duration work_time_{0};
  std::atomic<std::uint64_t> motions_applied_{0};
  CpuCosts costs_;
};

}  // namespace kerf
