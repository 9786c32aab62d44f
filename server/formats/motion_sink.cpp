// SPDX-License-Identifier: Apache-2.0
#include "server/formats/motion_sink.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "kernel/math/rotation.h"
#include "server/formats/machine_kinematics.h"
#include "server/formats/number_text.h"
#include "server/formats/pose_grid.h"

namespace kerf {
namespace {

// Slightly below the kernel's limit, because both ends are rounded to the pose grid.
constexpr double kTurnSplitRad = kTurnMaxRad - 1e-8;
// For turns nearer to a half turn than this, rounding of the ends determines the great circle.
constexpr double kOppositeRad = 1e-6;
// Most halvings of a piece. A path that is not straight then varies at the scale of the pose grid.
constexpr int kHalvingsMax = 20;

std::string out_of_range(Vec3 tip) {
  const double worst = std::max({std::abs(tip.x), std::abs(tip.y), std::abs(tip.z)});
  return "the tool would be " + decimal_text(worst, 6) + " mm from the origin; the limit is " +
         decimal_text(kCoordinateMaxMm, 6) + " mm";
}

bool in_range(Vec3 tip) {
  return is_finite(tip) && std::abs(tip.x) <= kCoordinateMaxMm &&
         std::abs(tip.y) <= kCoordinateMaxMm && std::abs(tip.z) <= kCoordinateMaxMm;
}

ToolPose between(const ToolPose& a, const ToolPose& b, double s) {
  return {a.tip_mm + (b.tip_mm - a.tip_mm) * s, turned_axis(a.axis, b.axis, s)};
}

// Greatest deviation of a tool of this length from the path if it moves straight from s0 to s1.
double straightness_mm(const MotionSink::Path& path, double s0, double s1, double tool_length_mm,
                       int samples) {
  const ToolPose a = path(s0);
  const ToolPose b = path(s1);
  double worst = 0;
  for (int i = 1; i < samples; ++i) {
    const double s = static_cast<double>(i) / samples;
    const ToolPose truth = path(s0 + (s1 - s0) * s);
    const ToolPose straight = between(a, b, s);
    worst = std::max(worst, length(truth.tip_mm - straight.tip_mm) +
                                tool_length_mm * length(truth.axis - straight.axis));
  }
  return worst;
}

}  // namespace

MotionSink::Result MotionSink::place(const ToolPose& pose) {
  if (!in_range(pose.tip_mm)) return std::unexpected(out_of_range(pose.tip_mm));
  last_ = admit_pose(pose);
  return {};
}

void MotionSink::remark(MachineRemark said) {
  if (said.kind == MachineRemark::Kind::kComment && !begun_) return;
  if (waits()) {
    late_.push_back(std::move(said));
  } else {
    record(std::move(said));
  }
}

void MotionSink::record(MachineRemark said) {
  if (said.text.size() > kRemarkTextMax) said.text.resize(kRemarkTextMax);
  if (program_.remarks.size() < kProgramRemarksMax)
    program_.remarks.push_back({made_, std::move(said)});
}

void MotionSink::change_tool(std::optional<ToolId> tool, std::size_t line) {
  begun_ = true;
  set_tool(tool);
  if (program_.tool_changes.size() < kProgramToolChangesMax)
    program_.tool_changes.push_back({tool.value_or(0), static_cast<std::uint32_t>(line), file_});
}

// A motion from the current pose.
std::expected<ProgramMotion, std::string> MotionSink::next_motion(bool rapid,
                                                                  std::size_t line) const {
  if (!tool_) return std::unexpected("no tool is loaded for this motion");
  return ProgramMotion{.tool = *tool_,
                       .from = *last_,
                       .to = *last_,
                       .line = static_cast<std::uint32_t>(line),
                       .rapid = rapid,
                       .file = file_};
}

MotionSink::Result MotionSink::append(ProgramMotion& next, const ToolPose& to, double duration_s) {
  if (!std::isfinite(duration_s) || duration_s > kDurationMaxS)
    return std::unexpected("the motion would take longer than " + decimal_text(kDurationMaxS, 0) +
                           " s; the feed is too low");
  if (++made_ > kProgramMotionsMax)
    return std::unexpected("the program exceeds the limit of " +
                           std::to_string(kProgramMotionsMax) + " motions");
  begun_ = true;
  next.to = to;
  next.duration_s = std::max(duration_s, kDurationMinS);
  program_.motions.push_back(next);
  next.from = to;
  cut_to_ = to;
  return {};
}

MotionSink::Result MotionSink::straight(ProgramMotion& next, const ToolPose& target,
                                        double duration_s) {
  if (!in_range(target.tip_mm)) return std::unexpected(out_of_range(target.tip_mm));
  const ToolPose to = admit_pose(target);
  if (to == next.from) return {};
  const double turn = angle_between(normalized(next.from.axis), normalized(to.axis));
  if (turn <= kTurnSplitRad) return append(next, to, duration_s);
  if (turn > std::numbers::pi - kOppositeRad)
    return std::unexpected(
        "the tool axis turns to its opposite in one motion, so its path is undefined; add a pose "
        "in between");
  const ToolPose middle = admit_pose(between(next.from, to, 0.5));
  if (Result first = append(next, middle, duration_s / 2); !first) return first;
  return append(next, to, duration_s / 2);
}

MotionSink::Result MotionSink::line(const ToolPose& target, double duration_s, bool rapid,
                                    std::size_t line) {
  if (waits()) return chords([target](double) { return target; }, 1, duration_s, rapid, line);
  if (!in_range(target.tip_mm)) return std::unexpected(out_of_range(target.tip_mm));
  const bool rests = admit_pose(target) == *last_;
  // A tool placed or loaded here removes the material inside it, like a motion of any length.
  // Rapids that repeat a point are common in approaches.
  if (rests && (rapid || !tool_ || cut_to_ == last_)) return {};
  auto next = next_motion(rapid, line);
  if (!next) return std::unexpected(next.error());
  if (rests) return append(*next, *last_, 0);
  const Result moved = straight(*next, target, duration_s);
  last_ = next->from;
  return moved;
}

MotionSink::Result MotionSink::wait(Waiting waiting) {
  auto next = next_motion(waiting.next.rapid, waiting.next.line);
  if (!next) return std::unexpected(next.error());
  waiting.next = *next;
  if (waiting.path) {
    const ToolPose end = waiting.path(1);
    last_ = in_range(end.tip_mm) ? admit_pose(end) : end;  // go_on() then ends the program
  }
  waiting_.push_back(std::move(waiting));
  begun_ = true;
  return {};
}

MotionSink::Result MotionSink::path(Path path, double tool_length_mm, double tolerance_mm,
                                    int samples, double duration_s, bool rapid, std::size_t line) {
  return wait({.next = {.line = static_cast<std::uint32_t>(line), .rapid = rapid},
               .path = std::move(path),
               .tool_length_mm = tool_length_mm,
               .tolerance_mm = tolerance_mm,
               .samples = samples,
               .duration_s = duration_s,
               .pieces = {{0, 1, 0}}});
}

MotionSink::Result MotionSink::chords(Path path, int count, double duration_s, bool rapid,
                                      std::size_t line) {
  return wait({.next = {.line = static_cast<std::uint32_t>(line), .rapid = rapid},
               .path = std::move(path),
               .chords = count,
               .duration_s = duration_s});
}

MotionSink::Result MotionSink::dwell(double duration_s, std::size_t line) {
  if (!last_ || !tool_ || duration_s == 0) return {};
  if (waits()) {
    return wait({.next = {.line = static_cast<std::uint32_t>(line)}, .duration_s = duration_s});
  }
  auto next = next_motion(false, line);
  if (!next) return std::unexpected(next.error());
  return append(*next, *last_, duration_s);
}

std::expected<bool, std::string> MotionSink::follow(Waiting& w) {
  const auto done = [](const Result& moved, bool at_end) -> std::expected<bool, std::string> {
    if (!moved) return std::unexpected(moved.error());
    return at_end;
  };
  if (!w.path) return done(append(w.next, w.next.from, w.duration_s), true);
  if (w.chords > 0) {
    const double s = static_cast<double>(++w.made) / w.chords;
    return done(straight(w.next, w.path(s), w.duration_s / w.chords), w.made == w.chords);
  }
  const Piece piece = w.pieces.back();
  w.pieces.pop_back();
  const int points = std::max(4, w.samples >> piece.halvings);
  const bool turns_far =
      angle_between(w.path(piece.s0).axis, w.path(piece.s1).axis) > std::numbers::pi / 2;
  if (piece.halvings < kHalvingsMax &&
      (turns_far ||
       straightness_mm(w.path, piece.s0, piece.s1, w.tool_length_mm, points) > w.tolerance_mm)) {
    const double middle = (piece.s0 + piece.s1) / 2;
    w.pieces.push_back({middle, piece.s1, piece.halvings + 1});
    w.pieces.push_back({piece.s0, middle, piece.halvings + 1});
    return false;
  }
  if (++w.made > kPiecesMax)
    return std::unexpected("the block exceeds the limit of " + std::to_string(kPiecesMax) +
                           " straight pieces");
  return done(straight(w.next, w.path(piece.s1), w.duration_s * (piece.s1 - piece.s0)),
              w.pieces.empty());
}

MotionSink::Result MotionSink::go_on(int steps) {
  for (; steps > 0 && waits(); --steps) {
    const auto is_done = follow(waiting_.front());
    if (!is_done) {
      waiting_.clear();
      return std::unexpected(is_done.error());
    }
    if (*is_done) waiting_.pop_front();
  }
  if (waits()) return {};
  for (MachineRemark& said : late_) record(std::move(said));
  late_.clear();
  return {};
}

}  // namespace kerf
