// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernel/sculpture_command.h"
#include "server/formats/program_path.h"
#include "server/session/memory_budget.h"
#include "server/session/program_alarms.h"
#include "server/store/journal_record.h"

namespace kerf {

using ProgramId = std::uint32_t;

enum class ProgramPace {
  kFeed,  ///< at `speed` times the programmed feed rate
  kFast   ///< as fast as possible while agents are served
};
/// Slowest and fastest speed of a program at feed rate.
inline constexpr double kProgramSpeedMin = 0.1, kProgramSpeedMax = 20;

enum class ProgramState {
  kQueued,  ///< waits for the end of another program
  kRunning,
  kPaused,
  kFinished,
  kCancelled,
  kFailed
};
/// Returns "queued", "running", "paused", "finished", "cancelled" or "failed".
const char* to_string(ProgramState state);
/// Whether a program has finished, was cancelled or has failed.
constexpr bool is_ended(ProgramState state) { return state >= ProgramState::kFinished; }

/// What changes while a program runs, and what a list of programs shows.
struct ProgramGlance {
  ProgramId id = 0;
  ParticipantId participant = 0;
  std::string name;
  ProgramPace pace = ProgramPace::kFast;
  double speed = 1;  ///< times the feed rate, at ProgramPace::kFeed
  ProgramState state = ProgramState::kRunning;
  ProgramId after = 0;  ///< kQueued: begins when this program has finished
  std::size_t motions_done = 0, motions = 0;
  std::uint32_t line = 0;  ///< of the motion carved last
  ToolId tool = 0;         ///< of the motion carved last, or the first one
  /// Cycle time at feed rate: of the motions carved, and of all.
  double elapsed_s = 0, programmed_s = 0;
  double feed_mm_per_min = 0;  ///< of the motion carved last
  double removed_mm3 = 0;
  std::size_t alarm_count = 0;
  bool waiting = false;  ///< for the journal, which does not accept motions now
  std::string error;     ///< of kFailed, with file name and line; why kCancelled, if by a queue
};

struct ProgramStatus : ProgramGlance {
  std::vector<ToolId> tools;  ///< in the order of their first motions
  std::string read_as;        ///< language of its text, and why it: "Haas: line 3 has G154"
  double machine_s = 0;       ///< time on the scene's machine; 0: unknown
  std::vector<std::string> warnings;
  std::vector<ProgramAlarm> alarms;  ///< the first ProgramAlarms::kListedMax
  std::string author;                ///< grant by which it was started; empty: none
  std::string target;                ///< the part that it is to make; empty: none
  double target_tolerance_mm = 0;    ///< below which depth a cut is an alarm
};

/// The text of a program as it was uploaded and its path, with the share of a budget that they
/// hold.
struct ProgramText {
  std::string text;
  ProgramPath path = {};
  MemoryBudget::Share memory = {};
};

/// As ProgramOptions::after: the newest program that has not ended, if there is one.
inline constexpr ProgramId kAfterNewest = ~ProgramId{0};

/// How a program is to be carved.
struct ProgramOptions {
  ProgramPace pace = ProgramPace::kFast;
  double speed = 1;
  ProgramId after = 0;      ///< begins when this program has finished; 0: at once
  std::string author = {};  ///< grant by which it is started; empty: none
  /// Mean cutting force of a motion above which there is an alarm, N; nothing: no limit.
  std::optional<double> force_limit_n = {};
  double tolerance_mm = 0;  ///< of the scene
  /// The part that the program is to make; null: gouges are not searched, which costs time.
  std::shared_ptr<const GougeReference> target = {};
  std::shared_ptr<const ProgramText> text = {};
  MemoryBudget::Share memory = {};  ///< held until the program ends
};

/// What is to happen with a program that has not ended.
enum class ProgramOrder {
  kPause,   ///< completes the motion that is being cut
  kResume,  ///< goes on where it was paused
  kStep     ///< carves the rest of the current block, or the next one, then pauses
};

}  // namespace kerf
