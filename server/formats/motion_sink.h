// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <expected>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/formats/program.h"

namespace kerf {

/// Shortest duration of a motion, s. Shorter ones are raised to it, because it must be above zero.
inline constexpr double kDurationMinS = 1e-9;
/// Longest duration of one block, s (31 years). A longer one means a mistyped feed.
inline constexpr double kDurationMaxS = 1e9;
/// Most pieces into which one block is divided.
inline constexpr int kPiecesMax = 1 << 20;

/// Appends motions to a Program for the readers of programs. Keeps the current tool and pose,
/// rounds poses to the pose grid and divides paths that are not one straight motion. The motions of
/// a path, and those after it, are pending until go_on(), so that they need no memory before. A
/// function that fails appends no further motion. Its error is one sentence, to which the caller
/// adds file and line.
class MotionSink {
 public:
  using Result = std::expected<void, std::string>;
  /// A path: the pose at s, from 0 (start) to 1 (end). Kept until its motions are made.
  using Path = std::function<ToolPose(double)>;

  /// `program` must outlive the sink.
  explicit MotionSink(Program& program) : program_(program) {}

  /// Sets the tool of the following motions (nullopt: no tool is loaded). Not a tool change of the
  /// program.
  void set_tool(std::optional<ToolId> tool) {
    if (tool != tool_) cut_to_.reset();
    tool_ = tool;
  }
  /// Sets the tool and records a tool change at `line`.
  void change_tool(std::optional<ToolId> tool, std::size_t line);
  /// Sets the file of the following motions: index into Program::files.
  void set_file(std::uint32_t file) { file_ = file; }
  std::optional<ToolId> tool() const { return tool_; }
  /// Takes the tool away from the workpiece. place() must precede the next motion.
  void lift() { last_.reset(); }
  bool placed() const { return last_.has_value(); }
  /// The current pose, or nullopt unless placed().
  const std::optional<ToolPose>& last() const { return last_; }

  /// Puts the tool at a pose without cutting. Error: the tip is out of range (kCoordinateMaxMm).
  Result place(const ToolPose& pose);
  /// Appends one straight motion to `to`, or two halves if it turns the axis by more than
  /// kTurnMaxRad. If `to` is the current pose, nothing is appended, unless a feed begins to cut
  /// there: then a motion without length, which removes the material inside the tool. Precondition:
  /// placed(). Errors: no tool, tip out of range, axis turned to its opposite, duration above
  /// kDurationMaxS, too many motions.
  Result line(const ToolPose& to, double duration_s, bool rapid, std::size_t line);
  /// Appends straight motions along a path. Pieces are halved until no point of a tool of the given
  /// length deviates by more than `tolerance_mm` from the path at the same time. `samples` points
  /// are compared on the whole path, at least four per piece. Errors, also of go_on(): those of
  /// line(), and more than kPiecesMax pieces.
  Result path(Path path, double tool_length_mm, double tolerance_mm, int samples, double duration_s,
              bool rapid, std::size_t line);
  /// Appends straight motions between `count` + 1 poses of a path at equal distances of s, `count`
  /// > 0.
  Result chords(Path path, int count, double duration_s, bool rapid, std::size_t line);
  /// Appends a rest at the current pose, unless the tool is away or absent or the duration is 0.
  Result dwell(double duration_s, std::size_t line);

  /// Records a remark after the motions made so far, pending ones included. A comment before the
  /// first tool change or motion is dropped.
  void remark(MachineRemark said);

  /// Whether motions wait.
  bool waits() const { return !waiting_.empty(); }
  /// Line and file of the first pending motion. Precondition: waits().
  struct Place {
    std::uint32_t line, file;
  };
  Place place_of_waiting() const {
    return {waiting_.front().next.line, waiting_.front().next.file};
  }
  /// Appends pending motions, at most `steps` pieces of paths. Errors: those of the pending calls,
  /// none of whose motions follows then.
  Result go_on(int steps);

 private:
  struct Piece {
    double s0, s1;
    int halvings;
  };
  /// A path that has been followed partly.
  struct Waiting {
    ProgramMotion next;  ///< begins at the end of the followed part
    Path path = {};      ///< empty: `next` is a rest
    int chords = 0;      ///< 0: halved as tolerance and samples require
    double tool_length_mm = 0, tolerance_mm = 0;
    int samples = 0;
    double duration_s = 0;
    std::vector<Piece> pieces = {};  ///< still to be followed, the next one last
    int made = 0;
  };
  std::expected<ProgramMotion, std::string> next_motion(bool rapid, std::size_t line) const;
  Result wait(Waiting waiting);
  void record(MachineRemark said);
  Result straight(ProgramMotion& next, const ToolPose& target, double duration_s);
  Result append(ProgramMotion& next, const ToolPose& to, double duration_s);
  /// Follows a path by one piece. Returns true at its end.
  std::expected<bool, std::string> follow(Waiting& waiting);

  Program& program_;
  std::uint32_t file_ = 0;
  std::optional<ToolId> tool_;
  std::optional<ToolPose> last_;    ///< after all pending motions
  std::optional<ToolPose> cut_to_;  ///< end of the tool's newest motion
  std::deque<Waiting> waiting_;
  std::size_t made_ = 0;             ///< motions
  bool begun_ = false;               ///< a tool change or a motion
  std::vector<MachineRemark> late_;  ///< after the pending motions
};

}  // namespace kerf
