// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/convert/rejection.h"
#include "server/formats/program.h"
#include "server/store/journal_record.h"

namespace kerf {

using ProgramId = std::uint32_t;

enum class ProgramPace { kFeed, kFast };  ///< as programmed; as fast as agents leave time for
enum class ProgramState { kRunning, kFinished, kCancelled, kFailed };
/// "running", "finished", "cancelled", "failed".
const char* to_string(ProgramState state);

struct ProgramStatus {
  ProgramId id = 0;
  ParticipantId participant = 0;
  std::string name;
  ProgramPace pace = ProgramPace::kFast;
  ProgramState state = ProgramState::kRunning;
  std::size_t motions_done = 0, motions = 0;
  std::uint32_t line = 0;  ///< of the motion carved last
  double removed_mm3 = 0, programmed_s = 0;
  std::string error;  ///< why it failed: one sentence with the line
  std::vector<std::string> warnings;
};

/// The programs that a session carves, in slices: after each slice the executor serves the agents,
/// so that the wait of an agent's motion is bounded by a slice and one program motion.
class ProgramRuns {
 public:
  using Clock = std::chrono::steady_clock;
  /// Carves one motion for a participant; gives the removed volume, mm^3.
  using Carve = std::function<std::expected<double, Rejection>(ParticipantId, const ProgramMotion&,
                                                               bool feel)>;
  /// Longest time for which a slice starts further motions.
  static constexpr std::chrono::microseconds kSlice{300};
  /// Reports kept of programs that ran; the oldest is forgotten first.
  static constexpr std::size_t kRemembered = 256;

  ProgramStatus start(ParticipantId participant, Program program, ProgramPace pace,
                      Clock::time_point now);
  bool cancel(ProgramId id);
  void cancel_all();
  std::optional<ProgramStatus> status(ProgramId id) const;
  std::vector<ProgramStatus> list() const;
  std::size_t running() const;
  /// The participants whose programs ended since the last call.
  std::vector<ParticipantId> take_ended();

  /// Carves what is due, each program in turn, for at most a slice. Gives how long to wait for the
  /// next slice; nullopt when no program runs.
  std::optional<std::chrono::microseconds> slice(const Carve& carve);

 private:
  struct Run {
    ProgramStatus status;
    Program program;
    Clock::time_point started;
    double done_s = 0;
  };
  bool due(const Run& run, Clock::time_point now) const;
  void step(Run& run, const Carve& carve);
  void forget_oldest();
  void end(Run& run, ProgramState state);

  std::map<ProgramId, Run> runs_;
  std::vector<ParticipantId> ended_;
  ProgramId last_id_ = 0;
};

}  // namespace kerf
