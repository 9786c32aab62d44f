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
  bool is_last = false;                    ///< of the program
  const GougeReference* target = nullptr;  ///< the part that it is to make; null: none
};

/// The programs of a session, carved in slices. Between slices the executor serves the agents, so
/// an agent waits for at most one slice and one program motion.
class ProgramRuns {
 public:
  /// Carves one motion; returns nothing if the motion takes longer: then it is called again with
  /// the same motion, in a later slice. kBusy: nothing was carved; the motion is tried again later.
  using Carve =
      std::function<std::expected<std::optional<CarvedMotion>, Rejection>(const ProgramStep&)>;
  /// Shows the tool of a participant's program on a motion that is not due yet.
  using Show = std::function<void(ParticipantId, const ToolPose&)>;
  /// A slice starts no further motion after this time.
  static constexpr std::chrono::microseconds kSlice{300};
  /// Time until a motion that was answered with kBusy is tried again.
  static constexpr std::chrono::microseconds kBusyPause{2000};
  /// Number of program statuses kept; the oldest finished one is dropped first.
  static constexpr std::size_t kStatusesMax = 256;
  /// Bytes of text that are kept of programs that have ended: one of the largest uploads.
  static constexpr std::size_t kEndedTextBytesMax = std::size_t{64} << 20;

  /// `options.after` names a program that has not ended, or 0.
  ProgramStatus start(ParticipantId participant, ProgramJob job, ProgramOptions options,
                      Clock::time_point now);
  /// Lists a program that ended before, with a number of its own and its text.
  void add_ended(ProgramStatus status, std::shared_ptr<const ProgramText> text);
  /// False if the program has ended or is still queued.
  bool order(ProgramId id, ProgramOrder order, Clock::time_point now);
  /// Carves the program as fast as possible from now on, or at `speed` times its feed rate; false
  /// if it has ended.
  bool set_pace(ProgramId id, ProgramPace pace, double speed, Clock::time_point now);
  bool cancel(ProgramId id);
  void cancel_all();
  std::optional<ProgramStatus> status(ProgramId id) const;
  std::vector<ProgramStatus> list() const;
  /// The programs that have not ended and the newest kEndedShown that have, in the order of their
  /// numbers.
  std::vector<ProgramGlance> glances() const;
  static constexpr std::size_t kEndedShown = 4;
  /// A number that grows whenever glances() may have changed.
  std::uint64_t changes() const { return changes_; }
  /// The newest program that has not ended; 0: there is none.
  ProgramId newest_open() const;
  /// The text of a program, kept as long as the program is listed and the texts of those that have
  /// ended have at most kEndedTextBytesMax bytes; null if there is none.
  std::shared_ptr<const ProgramText> text(ProgramId id) const;
  /// Drops the texts of programs that have ended, oldest first, until they have `bytes_max` bytes.
  void drop_ended_texts(std::size_t bytes_max);
  std::size_t running() const;
  /// Returns the participants whose programs ended since the previous call.
  std::vector<ParticipantId> take_ended();

  /// Carves the due motions, one per program in turn, for at most one slice, and shows where the
  /// tools of programs at feed rate are on the next ones. Returns the time to
  /// wait before the next slice; nullopt if no program is running: paused and queued ones cost
  /// nothing.
  std::optional<std::chrono::microseconds> slice(
      const Carve& carve, const Show& show = [](ParticipantId, const ToolPose&) {});

 private:
  struct Run {
    ProgramStatus status;
    std::shared_ptr<const ProgramText> text;
    std::optional<MotionStream> motions = {};  ///< until it ends; reads `text`
    MemoryBudget::Share memory = {};
    ProgramClock clock = {};
    ProgramAlarms alarms;
    std::shared_ptr<const GougeReference> target = {};  ///< until it ends
    double in_motion_s = 0;  ///< of the next motion, at feed rate: where its tool is shown
    bool in_pieces = false;  ///< the next motion is cut in part: it is completed before a pause
    bool pauses = false;     ///< as soon as possible
    bool steps = false;      ///< pauses before the first motion of another line than
    std::optional<std::uint32_t> only_line = {};  ///< this one, once it is known
    ProgramStatus status_now() const {
      ProgramStatus now = status;
      now.elapsed_s += in_motion_s;
      now.alarms = alarms.list();
      return now;
    }
    /// Null if it must be read first.
    const ProgramMotion* next() const { return motions ? motions->next() : nullptr; }
    /// What the program is behind its time, because the server was busy, is not made up for.
    void align(Clock::time_point now) {
      const double duration_s = next() == nullptr ? 0 : next()->duration_s;
      clock.clamp(status.elapsed_s, status.elapsed_s + duration_s, now);
    }
  };
  bool due(const Run& run, Clock::time_point now) const;
  void show_on_motion(Run& run, const Show& show, Clock::time_point now);
  /// Reads the next motion, unless that takes long: then it is called again. An error, which the
  /// reading before the start has not met, ends the program.
  void read_on(Run& run);
  /// Returns false if the motion must be tried again later.
  bool step(Run& run, const Carve& carve);
  /// Counts the motion that was carved, and pauses or ends the program if that is due.
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
