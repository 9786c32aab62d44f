// SPDX-License-Identifier: Apache-2.0
#include "server/formats/heidenhain/path.h"

#include <algorithm>
#include <cmath>

#include "server/formats/control/arc.h"
#include "server/formats/heidenhain/blocks.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr double kSampleStepDeg = 5;
constexpr double kTurnInBlockMaxDeg = 36000;
constexpr double kVerticalShare = 1e-12;  ///< of the axis' length
constexpr double kOppositeCosine = -0.999;

}  // namespace

Vec3 KlartextFrame::in_workpiece(Vec3 p) const {
  const double c = std::cos(kRadPerDeg * rotation_deg), s = std::sin(kRadPerDeg * rotation_deg);
  const Vec3 turned = rotation_deg == 0 ? p : Vec3{c * p.x - s * p.y, s * p.x + c * p.y, p.z};
  if (!is_tilted) return datum_mm + turned;
  return datum_mm + tilted[0] * turned.x + tilted[1] * turned.y + tilted[2] * turned.z;
}

Vec3 KlartextFrame::programmed(Vec3 in_workpiece) const {
  Vec3 p = in_workpiece - datum_mm;
  if (is_tilted) p = Vec3{dot(p, tilted[0]), dot(p, tilted[1]), dot(p, tilted[2])};
  if (rotation_deg == 0) return p;
  const double c = std::cos(kRadPerDeg * rotation_deg), s = std::sin(kRadPerDeg * rotation_deg);
  return {c * p.x + s * p.y, -s * p.x + c * p.y, p.z};
}

void KlartextPath::check(const MotionSink::Result& result) {
  if (!result) throw ProgramFault{"", result.error()};
}

void KlartextPath::require_uncompensated() const {
  if (is_compensated()) throw ProgramFault{"RL", "and RR must be ended with R0 before this block"};
}

void KlartextPath::change_tool(std::optional<ToolId> tool) {
  require_uncompensated();
  if (tool && !scene_.tools.contains(*tool))
    throw ProgramFault{"TOOL CALL", "the scene has no tool " + std::to_string(*tool)};
  changed_tool_ = changed_tool_ || tool.has_value();
  sink_.change_tool(tool, line_);
  if (!tool) sink_.lift();
}

void KlartextPath::retract() {
  require_uncompensated();
  sink_.lift();
  known_ =
      frame_.is_tilted ? std::array{false, false, false} : std::array{known_[0], known_[1], false};
}

void KlartextPath::lose(std::size_t axis) {
  require_uncompensated();
  sink_.lift();
  known_[axis] = false;
}

void KlartextPath::align() {
  require_uncompensated();
  sink_.lift();
  known_ = {false, false, false};
  plane_axis_ = frame_.is_tilted ? frame_.tilted[2] : Vec3{0, 0, 1};
  if (has_rotary_table(scene_.machine.kinematics))
    angles_ = angles_from_axis(scene_.machine, plane_axis_, angles_);
}

double& KlartextPath::angle(char axis) {
  return axis == 'A' ? angles_.a : axis == 'B' ? angles_.b : angles_.c;
}

void KlartextPath::count_angle(char axis, double near_deg) {
  double& deg = angle(axis);
  if (std::abs(deg - near_deg) > 180) deg = near_deg + std::remainder(deg - near_deg, 360.0);
}

void KlartextPath::reduce_angles(std::string_view axes) {
  for (const char axis : axes) {
    double& deg = angle(axis);
    deg = std::fmod(deg, 360.0);
    if (axis == 'C' && deg < 0) deg += 360;
  }
}

KlartextPath::PoseRule KlartextPath::poses() const {
  const MachineKinematics kind = scene_.machine.kinematics;
  return {scene_.machine, !frame_.is_tilted && has_rotary_table(kind), tool_center_, plane_axis_};
}

ToolPose KlartextPath::PoseRule::operator()(Vec3 tip_mm, const RotaryAngles& angles) const {
  if (!follows_tables) return {tip_mm, plane_axis};
  return {tip_from_programmed(machine, tool_center, tip_mm, angles), table_axis(machine, angles)};
}

bool KlartextPath::is_axis_z() const {
  const MachineKinematics kind = scene_.machine.kinematics;
  if (frame_.is_tilted) return true;
  if (!has_rotary_table(kind)) return plane_axis_.z > 1 - kVerticalShare;
  return !tool_center_ || table_axis(scene_.machine, angles_).z > 1 - kVerticalShare;
}

// Rapids only define the future position until all axes are known.
bool KlartextPath::approach(const ToolPose& to, bool rapid, std::array<bool, 3> named) {
  const bool known = known_[0] && known_[1] && known_[2];
  for (std::size_t i = 0; i < 3; ++i) known_[i] = known_[i] || named[i];
  if (sink_.placed() && sink_.tool()) return false;
  if (!sink_.tool() && !changed_tool_ && scene_.tools.size() == 1) {
    warn_("no tool is called; the scene's only tool is used");
    sink_.set_tool(scene_.tools.begin()->first);
  }
  if (rapid) {
    if (sink_.tool() && known_[0] && known_[1] && known_[2]) check(sink_.place(to));
    return true;
  }
  if (!sink_.tool() && !changed_tool_) {
    warn_("motions before the first TOOL CALL are left out: no tool cuts");
    return true;
  }
  if (!sink_.tool()) throw ProgramFault{"", "no tool is called for this motion"};
  if (!known)
    warn_(
        "X, Y and Z were not all programmed before this cut; the missing ones keep their last "
        "values, initially 0");
  check(sink_.place(pose(tip_mm_, angles_)));
  known_ = {true, true, true};
  return false;
}

void KlartextPath::move_line(Vec3 to, const RotaryAngles& angles, std::optional<double> feed,
                             std::array<bool, 3> named) {
  const Vec3 from = tip_mm_, target = frame_.in_workpiece(to);
  const RotaryAngles before = angles_;
  for (const double turn : {angles.a - before.a, angles.b - before.b, angles.c - before.c})
    if (!(std::abs(turn) <= kTurnInBlockMaxDeg))
      throw ProgramFault{"", "a rotary axis turns by more than 36000 degrees in one block"};
  const bool stays = target == from && angles == before;
  if (!(stays && !sink_.placed() && feed)) {
    if (!approach(pose(target, angles), !feed, named)) {
      const double deg = std::hypot(angles.a - before.a, angles.b - before.b, angles.c - before.c);
      const double mm = length(target - from);
      const double per_min = feed.value_or(scene_.machine.rapid_mm_per_min);
      const double seconds = 60 * (mm > 0 ? mm : deg) / per_min;
      if (angles == before) {
        check(sink_.line(pose(target, angles), seconds, !feed, line_));
      } else {
        const auto at = [before, angles, from, target, pose = poses()](double s) {
          const RotaryAngles turned{before.a + (angles.a - before.a) * s,
                                    before.b + (angles.b - before.b) * s,
                                    before.c + (angles.c - before.c) * s};
          return s >= 1 ? pose(target, angles) : pose(from + (target - from) * s, turned);
        };
        const double tool_mm = scene_.tools.at(*sink_.tool()).tool.length_mm;
        check(sink_.path(at, tool_mm, scene_.settings.tolerance_mm,
                         4 + static_cast<int>(deg / kSampleStepDeg), seconds, !feed, line_));
      }
    }
  }
  tip_mm_ = target;
  angles_ = angles;
}

void KlartextPath::line(Vec3 to, Vec3 axis, std::optional<double> feed, std::array<bool, 3> named) {
  const MachineKinematics kind = scene_.machine.kinematics;
  require_uncompensated();
  if (has_rotary_table(kind))
    return line(to, angles_from_axis(scene_.machine, axis, angles_), feed, named);
  if (kind != MachineKinematics::kToolVector && axis.z <= 1 - kVerticalShare)
    throw ProgramFault{"LN", "turns the tool, which the machine xyz cannot"};
  if (dot(axis, plane_axis_) <= kOppositeCosine)
    throw ProgramFault{"LN", "turns the tool to the opposite direction: the path is not defined"};
  beside_.reset();
  const Vec3 from = tip_mm_, target = frame_.in_workpiece(to), before = plane_axis_;
  const bool stays = target == from && axis == before;
  if (!approach({target, axis}, !feed, named) && !stays) {
    const FeedTravel travel = feed_travel({from, before}, {target, axis});
    const double seconds = 60 * travel.length() / feed.value_or(scene_.machine.rapid_mm_per_min);
    const auto at = [from, target, before, axis](double s) {
      return s >= 1 ? ToolPose{target, axis}
                    : ToolPose{from + (target - from) * s, turned_axis(before, axis, s)};
    };
    const double tool_mm = scene_.tools.at(*sink_.tool()).tool.length_mm;
    check(sink_.path(at, tool_mm, scene_.settings.tolerance_mm,
                     4 + static_cast<int>(travel.deg / kSampleStepDeg), seconds, !feed, line_));
  }
  tip_mm_ = target;
  center_ = to;
  plane_axis_ = axis;
}

void KlartextPath::move_arc(Vec3 to, ArcPlane plane, Vec3 center, int turns, double feed) {
  const Vec3 start = frame_.programmed(tip_mm_);
  const Arc arc = arc_about(start, to, plane, in_plane(center, plane), turns);
  const int chords = arc.chords(scene_.settings.tolerance_mm);
  if (chords > kPiecesMax) throw ProgramFault{"", "the arc has too many turns"};
  const Vec3 end = frame_.in_workpiece(to);
  if (approach(pose(end, angles_), false, {true, true, true})) {
    tip_mm_ = end;
    return;
  }
  const auto at = [arc, end, frame = frame_, angles = angles_, pose = poses()](double s) {
    return pose(s >= 1 ? end : frame.in_workpiece(arc.at(s)), angles);
  };
  check(sink_.chords(at, chords, 60 * arc.length_mm() / feed, false, line_));
  tip_mm_ = end;
}

void KlartextPath::dwell(double seconds) {
  if (compensation_.on()) return compensation_.dwell(seconds, info_of(std::nullopt, {}));
  check(sink_.dwell(seconds, line_));
}

}  // namespace kerf
