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
#include "server/session/memory_budget.h"
#include "server/store/journal_record.h"

namespace kerf {

using ProgramId = std::uint32_t;

enum class ProgramPace {
  kFeed,  ///< at the programmed feed rate
  kFast   ///< as fast as possible while agents are served
};
enum class ProgramState { kRunning, kFinished, kCancelled, kFailed };
/// Returns "running", "finished", "cancelled" or "failed".
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
  bool waiting = false;  ///< for the journal, which does not accept motions now
  std::string error;     ///< reason of kFailed, with file name and line
  std::vector<std::string> warnings;
};

/// One motion of a program, to be carved for its participant.
struct ProgramStep {
  ParticipantId participant = 0;
  const ProgramMotion& motion;
  bool feel = false;     ///< compute its force
  bool is_last = false;  ///< of the program
};

/// The programs of a session, carved in slices. Between slices the executor serves the agents, so
/// an agent waits for at most one slice and one program motion.
class ProgramRuns {
 public:
  using Clock = std::chrono::steady_clock;
  /// Carves one motion and returns the removed volume, mm^3; nothing if the motion takes longer:
  /// then it is called again with the same motion, in a later slice. kBusy: nothing was carved; the
  /// motion is tried again later.
  using Carve = std::function<std::expected<std::optional<double>, Rejection>(const ProgramStep&)>;
  /// A slice starts no further motion after this time.
  static constexpr std::chrono::microseconds kSlice{300};
  /// Time until a motion that was answered with kBusy is tried again.
  static constexpr std::chrono::microseconds kBusyPause{2000};
  /// Number of program statuses kept; the oldest finished one is dropped first.
  static constexpr std::size_t kStatusesMax = 256;

  /// `memory`: the share of a budget that the program holds until it ends.
  ProgramStatus start(ParticipantId participant, Program program, ProgramPace pace,
                      Clock::time_point now, MemoryBudget::Share memory = {});
  bool cancel(ProgramId id);
  void cancel_all();
  std::optional<ProgramStatus> status(ProgramId id) const;
  std::vector<ProgramStatus> list() const;
  std::size_t running() const;
  /// Bytes of the motions that are kept.
  std::size_t memory_bytes() const;
  /// Returns the participants whose programs ended since the previous call.
  std::vector<ParticipantId> take_ended();

  /// Carves the due motions, one per program in turn, for at most one slice. Returns the time to
  /// wait before the next slice; nullopt if no program is running.
  std::optional<std::chrono::microseconds> slice(const Carve& carve);

 private:
  struct Run {
    ProgramStatus status;
    Program program;
    Clock::time_point started;
    double done_s = 0;
    MemoryBudget::Share memory = {};
  };
  bool due(const Run& run, Clock::time_point now) const;
  /// Returns false if the motion must be tried again later.
  bool step(Run& run, const Carve& carve);
  void drop_oldest();
  void end(Run& run, ProgramState state);

  std::map<ProgramId, Run> runs_;
  std::vector<ParticipantId> ended_;
  ProgramId last_id_ = 0;
};

}  // namespace kerf
