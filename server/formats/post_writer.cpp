// SPDX-License-Identifier: Apache-2.0
#include "server/formats/post_writer.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <utility>

#include "kernel/math/rotation.h"
#include "server/formats/pose_grid.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

// Most halvings of one motion of a rotary machine. Pieces are then as small as the angle step.
constexpr int kTurnHalvingsMax = 16;
// When the C axis has turned this far, the tool is retracted and C is turned back to within one
// turn. LinuxCNC's sample machines allow 100 turns. Cables and hoses of real tables allow fewer.
constexpr double kWindUpMaxDeg = 20 * 360;

double rounded_to(double value, int decimals) {
  const double unit = std::pow(10.0, decimals);
  return std::round(value * unit) / unit;
}

}  // namespace

PostWriter::PostWriter(const PostRules& rules, const Scene& scene, std::ostream& out)
    : rules_(rules),
      scene_(scene),
      out_(out),
      kind_(scene.machine.kinematics),
      rotary_(has_rotary_table(kind_)),
      vector_(kind_ == MachineKinematics::kToolVector) {}

// Rounds a pose to the written decimals, so that differences that the control cannot see are no
// jumps.
ToolPose PostWriter::rounded(const ToolPose& pose) const {
  ToolPose result = pose;
  for (double* value : {&result.tip_mm.x, &result.tip_mm.y, &result.tip_mm.z})
    *value = rounded_to(*value, rules_.tip_decimals);
  return admit_pose(result);
}

WriteResult PostWriter::add(const ProgramMotion& given) { return write(given, nullptr); }

WriteResult PostWriter::add_arc(const ProgramMotion& motion, const FittedArc& arc) {
  return write(motion, &arc);
}

WriteResult PostWriter::write(const ProgramMotion& given, const FittedArc* fitted) {
  if (kind_ == MachineKinematics::kXyz)
    for (const Vec3& axis : {given.from.axis, given.to.axis})
      if (axis.x != 0 || axis.y != 0 || axis.z < 0)
        return std::unexpected(
            "the tool is tilted, which the scene's machine xyz cannot do; use a scene with the "
            "machine tool-vector, xyzac-trt or xyzbc-trt");
  if (!std::exchange(begun_, true)) begin();
  leave_hole();
  const bool rests = admit_pose(given.from) == admit_pose(given.to);
  const ToolPose from = rounded(given.from);
  const ToolPose to = rounded(given.to);
  ProgramMotion motion = given;
  motion.duration_s = std::max(given.duration_s, kWrittenDurationMinS) + std::exchange(late_s_, 0);
  const bool wound_up = std::abs(angles_.c) > kWindUpMaxDeg;
  if (wound_up) angles_.c = std::remainder(angles_.c, 360.0);
  if (!placed_ || wound_up || !(from == last_) || motion.tool != tool_) place(from, motion.tool);
  say_held(held_.size());
  if (rests) {
    dwell(motion.duration_s);
  } else if (from == to) {
    late_s_ = motion.duration_s;
  } else if (fitted != nullptr) {
    arc(to, fitted->keeps_center ? *fitted : with_equal_radii(*fitted, from.tip_mm, to.tip_mm),
        motion.duration_s);
  } else if (rotary_) {
    turn(from, to, motion, 0);
  } else {
    straight(to, motion.rapid, motion.duration_s);
  }
  last_ = to;
  return write_result(out_);
}

WriteResult PostWriter::add_hole(const ProgramMotion& first, const DrilledHole& given) {
  if (!std::exchange(begun_, true)) begin();
  const ToolPose from = rounded(first.from);
  if (!placed_ || !(from == last_) || first.tool != tool_) place(from, first.tool);
  say_held(held_.size());
  const DrilledHole hole = rounded(given);
  drill(hole);
  drills_ = true;
  last_.tip_mm = {hole.x_mm, hole.y_mm, hole.clear_mm};
  return write_result(out_);
}

void PostWriter::leave_hole() {
  if (std::exchange(drills_, false)) end_drilling();
}

DrilledHole PostWriter::rounded(const DrilledHole& hole) const {
  DrilledHole result = hole;
  for (double* mm : {&result.x_mm, &result.y_mm, &result.r_mm, &result.bottom_mm, &result.clear_mm,
                     &result.peck_mm})
    *mm = rounded_to(*mm, rules_.tip_decimals);
  return result;
}

WriteResult PostWriter::remark(const MachineRemark& said) {
  held_.push_back(said);
  return {};
}

WriteResult PostWriter::finish() {
  if (!std::exchange(begun_, true)) begin();
  leave_hole();
  if (placed_) retract();
  say_held(held_.size());
  end();
  out_.flush();
  return write_result(out_);
}

// Remarks that end or stop something precede a tool change. Those that start something follow it.
void PostWriter::place(const ToolPose& pose, ToolId tool) {
  leave_hole();
  retract();
  if (!placed_ || tool != tool_) {
    const auto first = std::ranges::find_if(held_, starts_something);
    say_held(static_cast<std::size_t>(first - held_.begin()));
    tool_ = tool;
    change_tool(!placed_);
  }
  placed_ = true;
  say_held(held_.size());
  angles_ = angles_from_axis(scene_.machine, normalized(pose.axis), angles_);
  approach(pose);
  last_ = pose;
}

void PostWriter::say_held(std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) say(held_[i]);
  held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(count));
}

double PostWriter::next_rpm() const {
  const auto next =
      std::ranges::find_if(held_, [](const MachineRemark& said) { return said.rpm > 0; });
  return next == held_.end() ? 0 : next->rpm;
}

double PostWriter::feed(const ToolPose& to, double duration_s) const {
  const double mm = length(to.tip_mm - last_.tip_mm);
  const double deg =
      std::hypot(end_angles_.a - angles_.a, end_angles_.b - angles_.b, end_angles_.c - angles_.c);
  const double turn_deg =
      rotary_ ? deg : kDegPerRad * angle_between(normalized(last_.axis), normalized(to.axis));
  return 60 * (mm > 0 ? mm : turn_deg) / duration_s;
}

// Writes a motion of a rotary machine, which interpolates its angles. Halves it until it deviates
// from the great circle by at most the tolerance at the end of the tool.
void PostWriter::turn(const ToolPose& from, const ToolPose& to, const ProgramMotion& motion,
                      int halvings) {
  const Vec3 a = normalized(from.axis);
  const Vec3 b = normalized(to.axis);
  const RotaryAngles end = angles_from_axis(scene_.machine, b, angles_);
  double deviation = 0;
  for (const double s : {0.25, 0.5, 0.75}) {
    const RotaryAngles angles{angles_.a + (end.a - angles_.a) * s,
                              angles_.b + (end.b - angles_.b) * s,
                              angles_.c + (end.c - angles_.c) * s};
    deviation =
        std::max(deviation, length(table_axis(scene_.machine, angles) - turned_axis(a, b, s)));
  }
  const double reach = reach_mm(scene_, motion.tool);
  if (deviation * reach > scene_.settings.tolerance_mm && halvings < kTurnHalvingsMax) {
    const ToolPose middle = rounded({(from.tip_mm + to.tip_mm) * 0.5, turned_axis(a, b, 0.5)});
    turn(from, middle, motion, halvings + 1);
    turn(middle, to, motion, halvings + 1);
    return;
  }
  last_ = from;
  end_angles_ = end;
  straight(to, motion.rapid, motion.duration_s / (1 << halvings));
  angles_ = end;
  last_ = to;
}

}  // namespace kerf
