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

void MotionSink::change_tool(std::optional<ToolId> tool, std::size_t line) {
  set_tool(tool);
  if (program_.tool_changes.size() < kProgramToolChangesMax)
    program_.tool_changes.push_back({tool.value_or(0), static_cast<std::uint32_t>(line), file_});
}

MotionSink::Result MotionSink::emit(const ToolPose& to, double duration_s, bool rapid,
                                    std::size_t line) {
  if (!tool_) return std::unexpected("no tool is loaded for this motion");
  if (!std::isfinite(duration_s) || duration_s > kDurationMaxS)
    return std::unexpected("the motion would take longer than " + decimal_text(kDurationMaxS, 0) +
                           " s; the feed is too low");
  if (program_.motions.size() >= kProgramMotionsMax)
    return std::unexpected("the program exceeds the limit of " +
                           std::to_string(kProgramMotionsMax) + " motions");
  program_.motions.push_back({.tool = *tool_,
                              .from = *last_,
                              .to = to,
                              .duration_s = std::max(duration_s, kDurationMinS),
                              .line = static_cast<std::uint32_t>(line),
                              .rapid = rapid,
                              .file = file_});
  last_ = to;
  return {};
}

MotionSink::Result MotionSink::line(const ToolPose& target, double duration_s, bool rapid,
                                    std::size_t line) {
  if (!in_range(target.tip_mm)) return std::unexpected(out_of_range(target.tip_mm));
  const ToolPose to = admit_pose(target);
  if (to == *last_) return {};
  const double turn = angle_between(normalized(last_->axis), normalized(to.axis));
  if (turn <= kTurnSplitRad) return emit(to, duration_s, rapid, line);
  if (turn > std::numbers::pi - kOppositeRad)
    return std::unexpected(
        "the tool axis turns to its opposite in one motion, so its path is undefined; add a pose "
        "in between");
  const ToolPose middle = admit_pose(between(*last_, to, 0.5));
  if (Result first = emit(middle, duration_s / 2, rapid, line); !first) return first;
  return emit(to, duration_s / 2, rapid, line);
}

MotionSink::Result MotionSink::path(const Path& path, double tool_length_mm, double tolerance_mm,
                                    int samples, double duration_s, bool rapid, std::size_t line) {
  // A stack of pieces still to be appended, the next one last.
  struct Piece {
    double s0, s1;
    int halvings;
  };
  std::vector<Piece> pending{{0, 1, 0}};
  int pieces = 0;
  while (!pending.empty()) {
    const Piece piece = pending.back();
    pending.pop_back();
    const int points = std::max(4, samples >> piece.halvings);
    const bool turns_far =
        angle_between(path(piece.s0).axis, path(piece.s1).axis) > std::numbers::pi / 2;
    if (piece.halvings < kHalvingsMax &&
        (turns_far ||
         straightness_mm(path, piece.s0, piece.s1, tool_length_mm, points) > tolerance_mm)) {
      const double middle = (piece.s0 + piece.s1) / 2;
      pending.push_back({middle, piece.s1, piece.halvings + 1});
      pending.push_back({piece.s0, middle, piece.halvings + 1});
      continue;
    }
    if (++pieces > kPiecesMax)
      return std::unexpected("the block exceeds the limit of " + std::to_string(kPiecesMax) +
                             " straight pieces");
    Result moved = this->line(path(piece.s1), duration_s * (piece.s1 - piece.s0), rapid, line);
    if (!moved) return moved;
  }
  return {};
}

MotionSink::Result MotionSink::dwell(double duration_s, std::size_t line) {
  if (!last_ || !tool_ || duration_s == 0) return {};
  return emit(*last_, duration_s, false, line);
}

}  // namespace kerf
