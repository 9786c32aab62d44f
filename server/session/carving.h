// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <expected>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "kernel/sculpture.h"
#include "server/convert/rejection.h"
#include "server/session/air_path.h"
#include "server/session/participants.h"
#include "server/session/program_runs.h"
#include "server/session/session_journal.h"
#include "server/session/session_limits.h"
#include "server/wire/types.h"

namespace kerf {

/// The reply to a batch of samples, for the agent that sent it.
struct MotionAnswer {
  wire::Result result;
  std::vector<Rejection> rejections;    ///< at most one per sample
  std::optional<wire::ToolState> felt;  ///< tool of the participant named by `feel_of`, if present
};

/// Turns samples and program motions into commands and applies them to the sculpture, each in the
/// order validate, journal, apply. Runs on the session's executor.
class Carving {
 public:
  /// The references must outlive this.
  Carving(const SessionLimits& limits, Sculpture& sculpture, SessionJournal& journal,
          Participants& participants);

  /// Carves a batch of samples of one participant. A rejected sample changes nothing and does not
  /// stop the samples after it.
  MotionAnswer move(ParticipantState& state, std::span<const wire::MotionSample> samples);
  /// Carves one motion of a program and returns the removed volume, mm^3. Consecutive motions
  /// through the air are joined (air_path.h): they are applied and journaled with the next motion
  /// that does not join them. Answers kBusy while the journal has no space for programs.
  std::expected<double, Rejection> move(const ProgramStep& step);
  /// The program of a participant has ended: applies the motions that are still to be joined.
  void end_program(ParticipantId id);

  /// Returns the tiles changed since the previous call, sorted.
  std::vector<TileIndex> take_changed();
  /// Motions applied since the server started (any thread).
  std::uint64_t motions_applied() const { return motions_applied_.load(std::memory_order_relaxed); }

 private:
  std::optional<Rejection> take_sample(ParticipantState& state, const wire::MotionSample& sample,
                                       BatchSum& sum);
  std::expected<MotionResult, Rejection> apply(ParticipantId id, const MoveTool& move);
  std::expected<void, Rejection> apply_air(ParticipantId id);
  std::expected<MotionResult, Rejection> apply_or_join(const ProgramStep& step);

  const SessionLimits& limits_;
  Sculpture& sculpture_;
  SessionJournal& journal_;
  Participants& participants_;
  AirSpace air_;
  std::map<ParticipantId, AirPath> air_paths_;  ///< of programs
  std::set<TileIndex> changed_;
  std::atomic<std::uint64_t> motions_applied_{0};
};

}  // namespace kerf
