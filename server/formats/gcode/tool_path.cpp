// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/tool_path.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/math/rotation.h"
#include "server/formats/control/fault.h"
#include "server/formats/gcode/parameters.h"
#include "server/formats/number_text.h"
#include "server/formats/pose_grid.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

// Farthest turn of a rotary axis in one block, degrees (100 turns). A longer one is a typing error.
constexpr double kTurnInBlockMaxDeg = 36000;
// Rotary travel per point at which a path is compared with a straight motion, degrees.
constexpr double kSampleStepDeg = 5;
// Number of chords that a spline's length is summed over, and of points compared with a chord.
constexpr int kSplineSamples = 64;

double rotary_travel_deg(const GcodeAxes& from, const GcodeAxes& to) {
  return std::hypot(to[3] - from[3], to[4] - from[4], to[5] - from[5]);
}

bool same_angles(const GcodeAxes& a, const GcodeAxes& b) { return rotary(a) == rotary(b); }

GcodeFrame workpiece_of(const GcodeEnvironment& environment) {
  GcodeFrame frame;
  if (!environment.parameters) return frame;
  const auto value = [&](int number) {
    const auto it = environment.parameters->find(number);
    return it == environment.parameters->end() ? 0.0 : it->second;
  };
  const int first = gcode_parameter::kSystem + gcode_parameter::kSystemStride;
  for (int axis = 0; axis < 6; ++axis)
    frame.origin[static_cast<std::size_t>(axis)] =
        value(first + axis) * (axis < 3 ? environment.machine_unit_mm : 1);
  frame.rotation_deg = value(first + gcode_parameter::kSystemRotation);
  return frame;
}

}  // namespace

GcodeToolPath::GcodeToolPath(const Scene& scene, const GcodeEnvironment& environment,
                             MotionSink& sink)
    : scene_(scene),
      table_(environment.tools ? &*environment.tools : nullptr),
      sink_(sink),
      zero_known_(environment.parameters.has_value()),
      workpiece_(workpiece_of(environment)) {}

void GcodeToolPath::check(const MotionSink::Result& result) {
  if (!result) throw ProgramFault{"", result.error()};
}

void GcodeToolPath::at_line(std::size_t file, std::size_t line) {
  line_ = line;
  sink_.set_file(static_cast<std::uint32_t>(file));
}

GcodePlace GcodeToolPath::in_workpiece(const GcodePlace& place) const {
  GcodePlace to{workpiece_.programmed(place.axes), place.tool_axis};
  if (!plane_) return to;
  const auto& [x, y, z] = plane_->axes;
  set_linear(to.axes, plane_->origin + x * to.axes[0] + y * to.axes[1] + z * to.axes[2]);
  to.tool_axis = z;
  return to;
}

void GcodeToolPath::check_turn(const GcodePlace& to) const {
  for (std::size_t i = 3; i < 6; ++i)
    if (std::abs(to.axes[i] - at_.axes[i]) > kTurnInBlockMaxDeg)
      throw ProgramFault{
          "", "a rotary axis would turn by " + decimal_text(to.axes[i] - at_.axes[i], 6) +
                  " degrees in one block; the limit is " + decimal_text(kTurnInBlockMaxDeg, 6)};
}

void GcodeToolPath::load_selected() {
  const auto tool = std::exchange(selected_, std::nullopt);
  if (!tool || changed_tool_ || scene_.tools.size() == 1 || !scene_.tools.contains(*tool)) return;
  if (sink_.tool() == tool) return;
  warn("T" + std::to_string(*tool) + " is used without M6: the operator has loaded it");
  sink_.change_tool(tool, line_);
}

bool GcodeToolPath::approach(const GcodePlace& to, bool rapid, std::array<bool, 6> named) {
  load_selected();
  const bool known = all_known();
  for (std::size_t i = 0; i < 3; ++i) known_[i] = known_[i] || named[i];
  if (sink_.placed() && sink_.tool()) return false;
  if (!sink_.tool() && !changed_tool_ && scene_.machine.spindle_tool > 0)
    sink_.set_tool(scene_.machine.spindle_tool);
  if (!sink_.tool() && !changed_tool_ && scene_.tools.size() == 1 && (all_known() || !rapid)) {
    warn("no tool is loaded; the scene's only tool is used");
    sink_.set_tool(scene_.tools.begin()->first);
  }
  if (rapid) {
    if (sink_.tool() && all_known()) check(sink_.place(pose(to)));
    tilted_since_ = tilted_since_ && !all_known();
    return true;
  }
  if (tilted_since_)
    throw ProgramFault{"", "X, Y and Z must be programmed with G0 before a cut in a new plane"};
  if (!sink_.tool())
    throw ProgramFault{
        "",
        "no tool is loaded for this motion; load one with T and M6, or state the tool in "
        "the spindle: machine.spindle_tool of the scene"};
  if (!known)
    warn(
        "X, Y and Z were not all programmed before this cut; the missing ones keep their last "
        "values, initially 0");
  check(sink_.place(pose(at_)));
  known_ = {true, true, true};
  return false;
}

void GcodeToolPath::rapid(const GcodePlace& absolute, GcodeRapid kind, std::array<bool, 6> named) {
  const GcodePlace to = in_workpiece(absolute);
  check_turn(to);
  if (kind == GcodeRapid::kMachine && !zero_known_) {
    // Without the machine zero the target is unknown. The tool leaves the workpiece.
    sink_.lift();
    for (std::size_t i = 0; i < 3; ++i)
      if (named[i]) known_[i] = false;
  } else if (!approach(to, true, named)) {
    straight(to, 0, true);
  }
  at_ = to;
}

void GcodeToolPath::feed(const GcodePlace& absolute, const GcodeFeed& feed,
                         std::array<bool, 6> named) {
  const GcodePlace to = in_workpiece(absolute);
  check_turn(to);
  // A block without motion requires no tool.
  if (to.axes == at_.axes && to.tool_axis == at_.tool_axis && !sink_.placed()) return;
  approach(to, false, named);
  straight(to, duration_s(feed, length(linear(to.axes) - linear(at_.axes)), turn_deg(to)), false);
  at_ = to;
}

double GcodeToolPath::turn_deg(const GcodePlace& to) const {
  if (scene_.machine.kinematics != MachineKinematics::kToolVector)
    return rotary_travel_deg(at_.axes, to.axes);
  return kDegPerRad * angle_between(normalized(at_.tool_axis), normalized(to.tool_axis));
}

double GcodeToolPath::duration_s(const GcodeFeed& feed, double travel_mm, double turn_deg) {
  if (feed.duration_s > 0) return feed.duration_s;
  // If only rotary axes move, F is in degrees per minute.
  return travel_mm > 0 ? 60 * travel_mm / feed.mm_per_min : 60 * turn_deg / feed.deg_per_min;
}

void GcodeToolPath::straight(const GcodePlace& to, double duration, bool rapid) {
  if (rapid) {
    const double travel_mm = length(linear(to.axes) - linear(at_.axes));
    duration = 60 * (travel_mm > 0 ? travel_mm : turn_deg(to)) / scene_.machine.rapid_mm_per_min;
  }
  if (same_angles(to.axes, at_.axes)) return check(sink_.line(pose(to), duration, rapid, line_));
  // Rotary axes move uniformly in their angles, which follows the great circle only approximately.
  const GcodePlace from = at_;
  const auto path = [to, from, pose = poses()](double s) {
    if (s >= 1) return pose(to);
    GcodePlace place = from;
    for (std::size_t i = 0; i < place.axes.size(); ++i)
      place.axes[i] += (to.axes[i] - from.axes[i]) * s;
    return pose(place);
  };
  const double travel = rotary_travel_deg(from.axes, to.axes);
  check(sink_.path(path, tool_length_mm(), scene_.settings.tolerance_mm,
                   4 + static_cast<int>(travel / kSampleStepDeg), duration, rapid, line_));
}

void GcodeToolPath::arc(const Arc& arc, const GcodeFrame& frame, const GcodePlace& absolute,
                        const GcodeFeed& feed, std::array<bool, 6> named) {
  const GcodePlace to = in_workpiece(absolute);
  check_turn(to);
  approach(to, false, named);
  const double factor = std::max(std::abs(frame.scale[0]), std::abs(frame.scale[1]));
  const double duration = duration_s(feed, arc.length_mm() * factor, 0);
  const double tolerance = scene_.settings.tolerance_mm;
  const int chords = arc.chords(tolerance / factor);
  if (chords > kPiecesMax)
    throw ProgramFault{"", "the arc exceeds the limit of " + std::to_string(kPiecesMax) +
                               " chords; raise tolerance_mm or reduce the turns (P)"};
  const GcodePlace from = at_;
  const auto path = [this, arc, frame, from, to, pose = poses()](double s) {
    if (s >= 1) return pose(to);
    GcodeAxes programmed{};
    set_linear(programmed, arc.at(s));
    GcodePlace place = in_workpiece({frame.absolute(programmed), from.tool_axis});
    for (std::size_t i = 3; i < 6; ++i)
      place.axes[i] = from.axes[i] + (to.axes[i] - from.axes[i]) * s;
    return pose(place);
  };
  if (same_angles(to.axes, from.axes)) {
    check(sink_.chords(path, chords, duration, false, line_));
  } else {
    const double travel = rotary_travel_deg(from.axes, to.axes);
    check(sink_.path(path, tool_length_mm(), tolerance,
                     4 * chords + static_cast<int>(travel / kSampleStepDeg), duration, false,
                     line_));
  }
  at_ = to;
}

void GcodeToolPath::spline(const std::vector<Vec3>& points, const GcodeFrame& frame,
                           const GcodePlace& absolute, const GcodeFeed& feed,
                           std::array<bool, 6> named) {
  const GcodePlace to = in_workpiece(absolute);
  approach(to, false, named);
  const GcodePlace from = at_;
  const auto place_at = [this, points, frame, from, to](double s) {
    if (s >= 1) return to;
    GcodeAxes start = frame.programmed(workpiece_.absolute(from.axes));
    std::vector<Vec3> level{linear(start)};
    level.insert(level.end(), points.begin(), points.end());
    // De Casteljau's algorithm: each level interpolates the neighbors of the previous one.
    for (std::size_t count = level.size() - 1; count > 0; --count)
      for (std::size_t i = 0; i < count; ++i) level[i] = level[i] + (level[i + 1] - level[i]) * s;
    set_linear(start, level.front());
    GcodePlace place = in_workpiece({frame.absolute(start), from.tool_axis});
    for (std::size_t i = 3; i < 6; ++i) place.axes[i] = from.axes[i];
    return place;
  };
  double travel_mm = 0;
  for (int i = 0; i < kSplineSamples; ++i)
    travel_mm += length(linear(place_at(static_cast<double>(i + 1) / kSplineSamples).axes) -
                        linear(place_at(static_cast<double>(i) / kSplineSamples).axes));
  check(sink_.path([place_at, pose = poses()](double s) { return pose(place_at(s)); },
                   tool_length_mm(), scene_.settings.tolerance_mm, kSplineSamples,
                   duration_s(feed, travel_mm, 0), false, line_));
  at_ = to;
}

void GcodeToolPath::dwell(double seconds) { check(sink_.dwell(seconds, line_)); }

void GcodeToolPath::change_tool(std::optional<ToolId> tool) {
  if (tool && !scene_.tools.contains(*tool))
    throw ProgramFault{"", "the scene has no tool " + std::to_string(*tool)};
  changed_tool_ = changed_tool_ || tool.has_value();  // T0 M6 alone names no tool of a scene
  sink_.change_tool(tool, line_);
  if (!tool) sink_.lift();
  if (table_ == nullptr) return;
  const auto entry = table_->find(static_cast<int>(tool.value_or(0)));
  const GcodeAxes before = loaded_;
  loaded_ = entry == table_->end() ? GcodeAxes{} : entry->second.offset;
  // The tip of the new tool is at another point without having moved there.
  if (loaded_ != before) sink_.lift();
}

void GcodeToolPath::offset_tool(const GcodeAxes& offset, const GcodePlace& at) {
  const std::optional<ToolPose> before = sink_.last();
  offset_ = offset;
  if (table_ == nullptr) loaded_ = offset;
  at_ = in_workpiece(at);
  if (before && admit_pose(pose(at_)) != *before) sink_.lift();
}

GcodePlace GcodeToolPath::control_tool_center(bool on, const GcodePlace& at) {
  if (on == tool_center_) return at;
  // The machine does not move. Only the coordinates of its position change.
  const Vec3 tip = pose(at_).tip_mm;
  tool_center_ = on;
  set_linear(at_.axes, programmed_from_tip(scene_.machine, on, tip, rotary(at_.axes)));
  return {workpiece_.absolute(at_.axes), at_.tool_axis};
}

void GcodeToolPath::tilt(const std::optional<TiltedPlane>& plane) {
  sink_.lift();
  known_ = {false, false, false};
  plane_ = plane;
  tilted_since_ = true;
}

double GcodeToolPath::tool_length_mm() const {
  const auto tool = sink_.tool();
  return tool ? scene_.tools.at(*tool).tool.length_mm : 0;
}

ToolPose GcodeToolPath::PoseRule::operator()(const GcodePlace& place) const {
  if (plane_axis) return {linear(place.axes) + *plane_axis * excess[2], *plane_axis};
  ToolPose pose{tip_from_programmed(machine, tool_center, linear(place.axes), rotary(place.axes)),
                machine.kinematics == MachineKinematics::kToolVector
                    ? place.tool_axis
                    : table_axis(machine, rotary(place.axes))};
  // The tip is displaced if the active offset is not that of the loaded tool.
  if (excess == GcodeAxes{}) return pose;
  pose.tip_mm = pose.tip_mm + Vec3{excess[0], excess[1], 0} + normalized(pose.axis) * excess[2];
  return pose;
}

}  // namespace kerf
