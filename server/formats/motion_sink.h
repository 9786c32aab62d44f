// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <string>

#include "server/formats/program.h"

namespace kerf {

/// Shortest duration that a motion is given, s: far below any machine's tick, only to keep it above
/// zero.
inline constexpr double kDurationMinS = 1e-9;
/// Longest duration of one block, s (31 years): beyond it a feed is a slip of the pen.
inline constexpr double kDurationMaxS = 1e9;
/// Most pieces that one block may be cut into.
inline constexpr int kPiecesMax = 1 << 20;

/// Where the readers put what they have understood: keeps the last pose, admits every pose to the
/// grid, and cuts what is not one straight motion into pieces. Errors are one sentence; the reader
/// adds file and line.
class MotionSink {
 public:
  using Result = std::expected<void, std::string>;
  /// A path from s = 0 to s = 1.
  using Path = std::function<ToolPose(double)>;

  explicit MotionSink(Program& program) : program_(program) {}

  /// The tool that the next motions move; none while no tool is loaded.
  void set_tool(std::optional<ToolId> tool) { tool_ = tool; }
  /// set_tool, where the program asks for it: it counts as a tool change.
  void change_tool(std::optional<ToolId> tool, std::size_t line);
  /// The motions that follow come from this file (Program::files).
  void set_file(std::uint32_t file) { file_ = file; }
  std::optional<ToolId> tool() const { return tool_; }
  /// The tool leaves the workpiece; the next thing must be place().
  void lift() { last_.reset(); }
  bool placed() const { return last_.has_value(); }
  const std::optional<ToolPose>& last() const { return last_; }

  /// Puts the tool somewhere without cutting.
  Result place(const ToolPose& pose);
  /// One straight motion (design section 3); cut in halves while it turns by more than kTurnMaxRad.
  Result line(const ToolPose& to, double duration_s, bool rapid, std::size_t line);
  /// A path that is neither straight nor uniform: cut until no point of a tool of this length is
  /// farther than `tolerance_mm` from where the path would have it at that time. `samples` points
  /// are compared per piece.
  Result path(const Path& path, double tool_length_mm, double tolerance_mm, int samples,
              double duration_s, bool rapid, std::size_t line);
  /// The tool stands still.
  Result dwell(double duration_s, std::size_t line);

 private:
  Result emit(const ToolPose& to, double duration_s, bool rapid, std::size_t line);

  Program& program_;
  std::uint32_t file_ = 0;
  std::optional<ToolId> tool_;
  std::optional<ToolPose> last_;
};

}  // namespace kerf
