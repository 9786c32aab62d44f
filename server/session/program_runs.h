// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "server/convert/rejection.h"
#include "server/platform/clock.h"
#include "server/session/program_clock.h"
#include "server/session/program_job.h"
#include "server/session/program_status.h"

namespace kerf {

/// One motion of a program, to be carved for its participant.
struct ProgramStep {
  ParticipantId participant = 0;
  const ProgramMotion& motion;
  bool feel = false;                       ///< compute its force
  bool is_last = false;                    ///< last motion of the program
  const GougeReference* target = nullptr;  ///< target part; null if none
};

/// The programs of a session, carved in slices. The executor serves agents between slices, so an
/// agent waits for at most one slice and one program motion.
class ProgramRuns {
 public:
  /// Carves one motion. Returns nullopt if the motion takes longer: it is then called with the same
  /// motion in a later slice. After kBusy, nothing was carved and the motion is retried later.
  using Carve =
      std::function<std::expected<std::optional<CarvedMotion>, Rejection>(const ProgramStep&)>;
  /// Shows the tool of a participant's program on a motion that is not due yet.
  using Show = std::function<void(ParticipantId, const ToolPose&)>;
  /// A slice starts no further motion after this time.
  static constexpr std::chrono::microseconds kSlice{300};
  /// Delay before a motion that failed with kBusy is retried.
  static constexpr std::chrono::microseconds kBusyPause{2000};
  /// Number of program statuses kept; the oldest finished one is dropped first.
  static constexpr std::size_t kStatusesMax = 256;
  /// Bytes of text kept for ended programs: one upload of maximum size.
  static constexpr std::size_t kEndedTextBytesMax = std::size_t{64} << 20;

  /// `options.after` names a program that has not ended, or 0.
  ProgramStatus start(ParticipantId participant, ProgramJob job, ProgramOptions options,
                      Clock::time_point now);
  /// Lists a program that ended before this start of the server, under a new number, with its text.
  void add_ended(ProgramStatus status, std::shared_ptr<const ProgramText> text);
  /// Carries out an order. Returns false if the program has ended or is still queued.
  bool order(ProgramId id, ProgramOrder order, Clock::time_point now);
  /// Sets the pace: as fast as possible, or `speed` times the feed rate. Returns false if the
  /// program has ended.
  bool set_pace(ProgramId id, ProgramPace pace, double speed, Clock::time_point now);
  bool cancel(ProgramId id);
  void cancel_all();
  std::optional<ProgramStatus> status(ProgramId id) const;
  std::vector<ProgramStatus> list() const;
  /// The programs that have not ended and the newest kEndedShown that have, in ascending order of
  /// their numbers.
  std::vector<ProgramGlance> glances() const;
  static constexpr std::size_t kEndedShown = 4;
  /// A counter that increases whenever glances() may have changed.
  std::uint64_t changes() const { return changes_; }
  /// The newest program that has not ended; 0 if there is none.
  ProgramId newest_open() const;
  /// The text of a program; null if none. Kept as long as the program is listed and the texts of
  /// ended programs fit in kEndedTextBytesMax.
  std::shared_ptr<const ProgramText> text(ProgramId id) const;
  /// Drops the texts of ended programs, oldest first, until at most `bytes_max` bytes remain.
  void drop_ended_texts(std::size_t bytes_max);
  std::size_t running() const;
  /// Returns the participants whose programs ended since the previous call.
  std::vector<ParticipantId> take_ended();

  /// Carves due motions, one per program in turn, for at most one slice. Shows the tools of
  /// programs at feed rate along their next motions. Returns the delay before the next slice.
  /// Nullopt if no program is running: paused and queued ones cost nothing.
  std::optional<std::chrono::microseconds> slice(
      const Carve& carve, const Show& show = [](ParticipantId, const ToolPose&) {});

 private:
  struct Run {
    ProgramStatus status;
    std::shared_ptr<const ProgramText> text;
    std::optional<MotionStream> motions = {};  ///< reads `text`; set until the program ends
    MemoryBudget::Share memory = {};
    ProgramClock clock = {};
    ProgramAlarms alarms;
    std::shared_ptr<const GougeReference> target = {};  ///< set until the program ends
    double in_motion_s = 0;  ///< position in the next motion, at feed rate, where the tool is shown
    bool in_pieces = false;  ///< the next motion is partly cut; it is completed before a pause
    bool pauses = false;     ///< pause as soon as possible
    bool steps = false;      ///< pause before the first motion of a line other than
    std::optional<std::uint32_t> only_line = {};  ///< this one, once it is known
    ProgramStatus status_now() const {
      ProgramStatus now = status;
      now.elapsed_s += in_motion_s;
      now.alarms = alarms.list();
      return now;
    }
    /// Null if the motion must be read first.
    const ProgramMotion* next() const { return motions ? motions->next() : nullptr; }
    /// Moves the clock into the next motion: a delay by a busy server is not made up for.
    void align(Clock::time_point now) {
      const double duration_s = next() == nullptr ? 0 : next()->duration_s;
      clock.clamp(status.elapsed_s, status.elapsed_s + duration_s, now);
    }
  };
  bool due(const Run& run, Clock::time_point now) const;
  void show_on_motion(Run& run, const Show& show, Clock::time_point now);
  /// Reads the next motion. If that takes long, it must be called again. An error that the first
  /// reading did not find ends the program.
  void read_on(Run& run);
  /// Returns false if the motion must be tried again later.
  bool step(Run& run, const Carve& carve);
  /// Counts the carved motion. Pauses or ends the program if that is due.
  void advance(Run& run, const CarvedMotion& carved);
  void begin(Run& run, Clock::time_point now);
  void pause(Run& run, Clock::time_point now);
  void drop_oldest();
  void end(Run& run, ProgramState state);
  /// Begins the programs that are queued after one that has ended, or cancels them.
  void end_wait(const ProgramStatus& ended);

  std::map<ProgramId, Run> runs_;
  std::vector<ParticipantId> ended_;
  ProgramId last_id_ = 0;
  std::uint64_t changes_ = 0;
};

}  // namespace kerf
