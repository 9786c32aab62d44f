// The motions of GcodeMachine: targets, straight lines, arcs, feeds.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernel/math/rotation.h"
#include "server/formats/gcode/fault.h"
#include "server/formats/gcode/machine.h"

namespace kerf {
namespace {

constexpr std::string_view kCenterLetters = "ijk";
constexpr double kDegPerRad = 180 / std::numbers::pi;
// A rotary axis that turns farther than this in one block is a slip of the pen.
constexpr double kTurnInBlockMaxDeg = 36000;
// The path is compared with a straight motion once for each step of this much rotary travel.
constexpr double kSampleStepDeg = 5;
constexpr int kTurnsMax = 1000;

double rotary_travel_deg(const RotaryAngles& from, const RotaryAngles& to) {
  return std::hypot(to.a - from.a, to.b - from.b, to.c - from.c);
}

}  // namespace

GcodeMachine::Position GcodeMachine::read_target(GcodeBlock& block) {
  const Offset sum = offset();
  std::array<double, 6> to{};
  for (int axis = 0; axis < 6; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    to[i] = current(axis);
    const auto value = block.take(kAxisLetters[i]);
    if (!value) continue;
    const double written = *value * (axis < 3 ? unit_mm_ : 1);
    to[i] = written + (incremental_ ? to[i] : sum[i]);
    if (axis < 3) known_[i] = true;
  }
  Position target{{to[0], to[1], to[2]}, {to[3], to[4], to[5]}, at_.axis};
  for (const double turn : {target.angles.a - at_.angles.a, target.angles.b - at_.angles.b,
                            target.angles.c - at_.angles.c})
    if (std::abs(turn) > kTurnInBlockMaxDeg)
      throw GcodeFault{
          "", "a rotary axis would turn by " + std::to_string(turn) + " degrees in one block"};
  return target;
}

Vec3 GcodeMachine::read_tool_axis(GcodeBlock& block) {
  const auto i = block.take('i');
  const auto j = block.take('j');
  const auto k = block.take('k');
  if (!i && !j && !k) return at_.axis;
  if (!i || !j || !k) throw GcodeFault{"I J K", "the tool axis needs all three of I, J and K"};
  const Vec3 axis{*i, *j, *k};
  const double size = length(axis);
  if (!(size > 1e-6) || !std::isfinite(size))
    throw GcodeFault{"I J K", "the tool axis has no direction"};
  return axis;
}

void GcodeMachine::move(GcodeBlock& block) {
  const GcodeCode* special = block.code(GcodeGroup::kNonModal);
  if (const GcodeCode* code = block.code(GcodeGroup::kMotion)) {
    if (code->code == 800 && block.has_any(kAxisLetters))
      throw GcodeFault{code->text, "ends motions; it takes no axis words"};
    motion_ = code->code == 0    ? Motion::kRapid
              : code->code == 10 ? Motion::kFeed
              : code->code == 20 ? Motion::kClockwise
              : code->code == 30 ? Motion::kCounterClockwise
                                 : Motion::kNone;
  }
  if (special != nullptr && takes_axis_words(special->code)) return;
  if (special != nullptr && special->code == 530) return rapid_in_machine_coordinates(block);
  const bool arc_motion = motion_ == Motion::kClockwise || motion_ == Motion::kCounterClockwise;
  const bool vector = scene_.machine.kinematics == MachineKinematics::kToolVector;
  if (!block.has_any(kAxisLetters) && !((arc_motion || vector) && block.has_any(kCenterLetters)))
    return;
  if (motion_ == Motion::kNone)
    throw GcodeFault{"", "axis words need a motion code (G0, G1, G2, G3) in force"};
  const bool known = known_[0] && known_[1] && known_[2];
  Position target = read_target(block);
  if (arc_motion) {
    approach(target, false, known);
    arc(block, target);
  } else {
    if (vector) target.axis = read_tool_axis(block);
    const bool rapid = motion_ == Motion::kRapid;
    if (!approach(target, rapid, known)) {
      const double turn =
          vector ? kDegPerRad * angle_between(normalized(at_.axis), normalized(target.axis))
                 : rotary_travel_deg(at_.angles, target.angles);
      const double way = length(target.xyz - at_.xyz);
      straight(target, rapid ? 0 : feed_duration_s(block, way, turn), rapid);
    }
  }
  at_ = target;
}

bool GcodeMachine::approach(const Position& target, bool rapid, bool known) {
  if (sink_.placed() && sink_.tool()) return false;
  const bool arrives = known_[0] && known_[1] && known_[2];
  if (!sink_.tool() && !changed_tool_ && scene_.tools.size() == 1 && (arrives || !rapid)) {
    warn_("no tool was loaded; the scene's only tool is taken");
    sink_.set_tool(scene_.tools.begin()->first);
  }
  if (rapid) {
    if (sink_.tool() && arrives) check(sink_.place(pose(target)));
    return true;
  }
  if (!sink_.tool()) throw GcodeFault{"", "a motion needs a tool, and none is loaded"};
  if (!known)
    warn_(
        "X, Y and Z were not all programmed before this cut; the others are taken as they were, at "
        "first 0");
  check(sink_.place(pose(at_)));
  known_ = {true, true, true};
  return false;
}

void GcodeMachine::rapid_in_machine_coordinates(GcodeBlock& block) {
  if (motion_ != Motion::kRapid)
    throw GcodeFault{"G53", "only G53 G0 is supported: Kerf does not know the machine's zero"};
  // Kerf does not know where the machine's zero is, only that the tool leaves the workpiece.
  const std::array<bool, 6> named{block.take('x').has_value(), block.take('y').has_value(),
                                  block.take('z').has_value(), block.take('a').has_value(),
                                  block.take('b').has_value(), block.take('c').has_value()};
  if (named[3] || named[4] || named[5])
    throw GcodeFault{"G53", "rotary axes in machine coordinates are not supported"};
  if (!named[0] && !named[1] && !named[2]) throw GcodeFault{"G53", "needs an axis word"};
  sink_.lift();
  for (std::size_t i = 0; i < 3; ++i)
    if (named[i]) known_[i] = false;
}

void GcodeMachine::straight(const Position& target, double duration_s, bool rapid) {
  if (rapid) {
    const double way = length(target.xyz - at_.xyz);
    const double turn = rotary_travel_deg(at_.angles, target.angles);
    const double axis_turn =
        kDegPerRad * angle_between(normalized(at_.axis), normalized(target.axis));
    duration_s = 60 * (way > 0 ? way : turn + axis_turn) / scene_.machine.rapid_mm_per_min;
  }
  if (target.angles == at_.angles) {
    check(sink_.line(pose(target), duration_s, rapid, line_));
    return;
  }
  // Rotary axes turn uniformly in their angles, which is the great circle only nearly.
  const Position from = at_;
  const auto path = [&](double s) {
    if (s >= 1) return pose(target);
    const auto mix = [s](double a, double b) { return a + (b - a) * s; };
    return pose({from.xyz + (target.xyz - from.xyz) * s,
                 {mix(from.angles.a, target.angles.a), mix(from.angles.b, target.angles.b),
                  mix(from.angles.c, target.angles.c)},
                 from.axis});
  };
  const double travel = rotary_travel_deg(from.angles, target.angles);
  check(sink_.path(path, tool_length_mm(), scene_.settings.tolerance_mm,
                   4 + static_cast<int>(travel / kSampleStepDeg), duration_s, rapid, line_));
}

ArcCenter GcodeMachine::read_center(GcodeBlock& block, ArcPlane plane) {
  ArcCenter center;
  center.absolute = arc_absolute_;
  if (const auto radius = block.take('r')) {
    if (block.has_any(kCenterLetters))
      throw GcodeFault{block.find('r')->text, "may not stand with I, J or K"};
    if (*radius == 0) throw GcodeFault{block.find('r')->text, "the radius must not be 0"};
    center.radius = *radius * unit_mm_;
    return center;
  }
  const std::string_view letters = plane == ArcPlane::kXy   ? "ij"
                                   : plane == ArcPlane::kZx ? "ki"
                                                            : "jk";
  for (const char letter : kCenterLetters) {
    const GcodeWord* word = block.find(letter);
    if (word != nullptr && letters.find(letter) == std::string_view::npos)
      throw GcodeFault{word->text, "is not an offset in the selected plane"};
  }
  if (!block.has_any(letters)) throw GcodeFault{"", "an arc needs R, or the offsets of its centre"};
  if (arc_absolute_ && (block.find(letters[0]) == nullptr || block.find(letters[1]) == nullptr))
    throw GcodeFault{"G90.1", "an arc needs both coordinates of its centre"};
  const Offset sum = arc_absolute_ ? offset() : Offset{};
  center.ijk = {block.take('i').value_or(0) * unit_mm_ + sum[0],
                block.take('j').value_or(0) * unit_mm_ + sum[1],
                block.take('k').value_or(0) * unit_mm_ + sum[2]};
  return center;
}

void GcodeMachine::arc(GcodeBlock& block, const Position& target) {
  const ArcCenter center = read_center(block, plane_);
  int turns = 1;
  if (const auto p = block.take('p')) {
    if (*p < 1 || *p > kTurnsMax || *p != std::floor(*p))
      throw GcodeFault{block.find('p')->text, "the number of turns must be whole, from 1 to 1000"};
    turns = static_cast<int>(*p);
  }
  const Arc arc =
      make_arc(at_.xyz, target.xyz, plane_, center, motion_ == Motion::kClockwise, turns);
  const double duration = feed_duration_s(block, arc.length_mm(), 0);
  const double tolerance = scene_.settings.tolerance_mm;
  const int chords = arc.chords(tolerance);
  if (chords > kPiecesMax) throw GcodeFault{"", "the arc would need too many chords"};
  if (target.angles == at_.angles) {
    for (int i = 1; i <= chords; ++i) {
      const Position to{arc.at(static_cast<double>(i) / chords), at_.angles, at_.axis};
      check(sink_.line(pose(to), duration / chords, false, line_));
    }
    return;
  }
  const Position from = at_;
  const auto path = [&](double s) {
    const auto mix = [s](double a, double b) { return s >= 1 ? b : a + (b - a) * s; };
    return pose({arc.at(s),
                 {mix(from.angles.a, target.angles.a), mix(from.angles.b, target.angles.b),
                  mix(from.angles.c, target.angles.c)},
                 from.axis});
  };
  const double travel = rotary_travel_deg(from.angles, target.angles);
  check(sink_.path(path, tool_length_mm(), tolerance,
                   4 * chords + static_cast<int>(travel / kSampleStepDeg), duration, false, line_));
}

double GcodeMachine::feed_duration_s(const GcodeBlock& block, double length_mm,
                                     double turn_deg) const {
  if (feed_mode_ == FeedMode::kInverseTime) {
    if (block.find('f') == nullptr || feed_ <= 0)
      throw GcodeFault{"", "in inverse time (G93) every cutting block needs its own F above 0"};
    return 60 / feed_;
  }
  if (feed_mm_ <= 0) throw GcodeFault{"", "the feed is 0: give F before the first cutting motion"};
  const bool turn_only = length_mm == 0;
  // Where only rotary axes move, F is in degrees per minute.
  const double way = turn_only ? turn_deg : length_mm;
  const double feed = turn_only ? feed_ : feed_mm_;
  if (feed_mode_ == FeedMode::kPerMinute) return 60 * way / feed;
  if (spindle_rpm_ <= 0)
    throw GcodeFault{"", "feed per revolution (G95) needs a spindle speed S above 0"};
  return 60 * way / (feed * spindle_rpm_);
}

}  // namespace kerf
