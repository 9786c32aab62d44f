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
  kFast   ///< as fast as possible between the agents' motions
};
/// Minimum and maximum speed of a program at feed rate.
inline constexpr double kProgramSpeedMin = 0.1, kProgramSpeedMax = 20;

enum class ProgramState {
  kQueued,  ///< waits for another program to end
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

/// The changing state of a program, as lists show it.
struct ProgramGlance {
  ProgramId id = 0;
  ParticipantId participant = 0;
  std::string name;
  ProgramPace pace = ProgramPace::kFast;
  double speed = 1;  ///< multiple of the feed rate, at ProgramPace::kFeed
  ProgramState state = ProgramState::kRunning;
  ProgramId after = 0;  ///< kQueued: begins when this program has finished
  std::size_t motions_done = 0, motions = 0;
  std::uint32_t line = 0;  ///< of the last motion carved
  ToolId tool = 0;         ///< of the last motion carved, or the first one
  /// Cycle time at feed rate: of the motions carved, and of all.
  double elapsed_s = 0, programmed_s = 0;
  double feed_mm_per_min = 0;  ///< of the last motion carved
  double removed_mm3 = 0;
  std::size_t alarm_count = 0;
  bool waiting = false;  ///< for the journal, which accepts no motions at the moment
  std::string error;     ///< kFailed: file name, line and reason; kCancelled by a queue: the reason
};

struct ProgramStatus : ProgramGlance {
  std::vector<ToolId> tools;  ///< in order of first use
  std::string read_as;        ///< language and its evidence: "Haas: line 3 has G154"
  double machine_s = 0;       ///< cycle time on the scene's machine; 0 if unknown
  std::vector<std::string> warnings;
  std::vector<ProgramAlarm> alarms;  ///< the first ProgramAlarms::kListedMax
  std::string author;                ///< grant that started it; empty if none
  std::string target;                ///< target part; empty if none
  double target_tolerance_mm = 0;    ///< maximum depth of a cut below the target part
};

/// The uploaded text and the path of a program, with the memory share that they occupy.
struct ProgramText {
  std::string text;
  ProgramPath path = {};
  MemoryBudget::Share memory = {};
};

/// A value of ProgramOptions::after: the newest program that has not ended, if there is one.
inline constexpr ProgramId kAfterNewest = ~ProgramId{0};

/// How a program is to be carved.
struct ProgramOptions {
  ProgramPace pace = ProgramPace::kFast;
  double speed = 1;
  ProgramId after = 0;      ///< begins when this program has finished; 0: at once
  std::string author = {};  ///< grant that starts it; empty if none
  /// Mean cutting force of a motion, N, above which there is an alarm; nullopt for no limit.
  std::optional<double> force_limit_n = {};
  double tolerance_mm = 0;  ///< of the scene
  /// The target part. If null, there is no search for gouges, which costs time.
  std::shared_ptr<const GougeReference> target = {};
  std::shared_ptr<const ProgramText> text = {};
  MemoryBudget::Share memory = {};  ///< held until the program ends
};

/// Orders for a program that has not ended.
enum class ProgramOrder {
  kPause,   ///< completes the motion that is being cut
  kResume,  ///< continues a paused program
  kStep     ///< carves the rest of the current block, or the next one, then pauses
};

}  // namespace kerf
