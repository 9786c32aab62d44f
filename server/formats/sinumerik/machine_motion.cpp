// SPDX-License-Identifier: Apache-2.0
// Motions of SinumerikMachine.
#include <algorithm>
#include <cmath>

#include "server/formats/control/fault.h"
#include "server/formats/sinumerik/machine.h"

namespace kerf {
namespace {

constexpr std::string_view kAxes = "XYZABC";
constexpr double kTurnsMax = 1000;

double& part(Vec3& v, std::size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

}  // namespace

SinumerikWord* SinumerikMachine::take(Words& words, std::string_view name) {
  for (SinumerikWord& word : words)
    if (word.name == name && word.kind == SinumerikWord::Kind::kValue)
      return word.used = true, &word;
  return nullptr;
}

GcodePlace SinumerikMachine::place(const GcodeAxes& programmed) const {
  return {frame_.absolute(programmed), axis_};
}

GcodeFeed SinumerikMachine::feed() const {
  require_no_swivel();
  if (!(feed_ > 0)) throw ProgramFault{"", "the feed is 0; give F before the first cutting motion"};
  if (feed_mode_ == FeedMode::kInverse) return {.duration_s = 60 / feed_};
  const double turns = feed_mode_ == FeedMode::kPerRevolution ? rpm_ : 1;
  if (!(turns > 0)) throw ProgramFault{"G95", "requires a spindle speed S above 0"};
  return {.mm_per_min = feed_ * feed_unit_mm_ * turns, .deg_per_min = feed_ * turns};
}

// The end of the block in programmed coordinates.
GcodeAxes SinumerikMachine::target(Words& words, Named& named) {
  GcodeAxes to = programmed();
  const std::string_view others = plane_ == ArcPlane::kXy   ? "XY"
                                  : plane_ == ArcPlane::kZx ? "ZX"
                                                            : "YZ";
  if (beside_ && std::ranges::any_of(words, [others](const SinumerikWord& word) {
        return !word.used && word.name.size() == 1 && others.find(word.name) != std::string::npos;
      })) {
    const double normal = in_plane(linear(to), plane_).normal;
    set_linear(to, from_plane({beside_->first, beside_->second, normal}, plane_));
    beside_.reset();
  }
  for (SinumerikWord& word : words) {
    const std::size_t axis = kAxes.find(word.name);
    if (word.used || word.name.size() != 1 || axis == std::string_view::npos) continue;
    if (word.kind != SinumerikWord::Kind::kValue) throw ProgramFault{word.name, "has no value"};
    const MachineKinematics kind = scene_.machine.kinematics;
    const bool exists = axis < 3 || (axis == 5 && has_rotary_table(kind)) ||
                        (axis == 3 && kind == MachineKinematics::kXyzacTrt) ||
                        (axis == 4 && kind == MachineKinematics::kXyzbcTrt);
    if (!exists)
      throw ProgramFault{word.name, "the machine " + std::string(to_string(kind)) + " has no " +
                                        word.name + " axis"};
    if (axis >= 3 && tilted_)
      throw ProgramFault{word.name, "turns a table in a plane of CYCLE800, which is not supported"};
    const bool adds = word.how == SinumerikWord::How::kIncremental ||
                      (word.how == SinumerikWord::How::kModal && incremental_);
    to[axis] = word.value * (axis < 3 ? unit_mm_ : 1) + (adds ? to[axis] : 0);
    named[axis] = word.used = true;
  }
  return to;
}

// A3=… B3=… C3=…: the direction of the tool.
std::optional<Vec3> SinumerikMachine::tool_axis(Words& words) {
  const SinumerikWord* parts[] = {take(words, "A3"), take(words, "B3"), take(words, "C3")};
  if (std::ranges::none_of(parts, [](const auto* word) { return word != nullptr; }))
    return std::nullopt;
  if (scene_.machine.kinematics != MachineKinematics::kToolVector)
    throw ProgramFault{"A3",
                       "gives the tool's direction, which requires a scene whose machine is "
                       "tool-vector"};
  if (!follows_tool_) throw ProgramFault{"A3", "requires TRAORI before it"};
  Vec3 axis{0, 0, 0};
  for (std::size_t i = 0; i < 3; ++i)
    if (parts[i] != nullptr) part(axis, i) = parts[i]->value;
  if (!(length(axis) > 1e-6)) throw ProgramFault{"A3", "must not be the vector 0, 0, 0"};
  double x = axis.x, y = axis.y;
  turn_xy(x, y, frame_.rotation_deg);
  return Vec3{x, y, axis.z};
}

void SinumerikMachine::move(Words& words) {
  Corner corner;
  for (const char* name : {"RND", "CHF", "CHR"})
    corner.own = corner.own || std::ranges::find(words, name, &SinumerikWord::name) != words.end();
  read_corner(words, corner);
  Named named{};
  const GcodeAxes to = target(words, named);
  const auto axis = tool_axis(words);
  const bool any = std::ranges::find(named, true) != named.end();
  const bool circle = motion_ != Motion::kRapid && motion_ != Motion::kLine;
  if (axis) axis_ = *axis;
  if (circle && (any || std::ranges::any_of(words, [](const SinumerikWord& word) {
                   return !word.used && (word.name == "I" || word.name == "J" || word.name == "K");
                 }))) {
    if (axis) throw ProgramFault{"A3", "beside an arc is not supported"};
    if (corner.own && corner.any())
      throw ProgramFault{"RND",
                         "RND, CHF and CHR beside an arc are not supported; post the corner"};
    require_no_corner("G2");
    release_corner();
    arc(words, to, named);
  } else if (any || axis) {
    line(to, named, axis.has_value(), corner);
  }
  if (modal_hole_ && any) {
    hole_ = modal_hole_;
    drill();
  }
}

// Makes a line, or delays it if a corner ends it.
void SinumerikMachine::line(const GcodeAxes& to, const Named& named, bool turns, Corner corner) {
  const bool rapid = motion_ == Motion::kRapid;
  const bool tables = named[3] || named[4] || named[5] || turns;
  const GcodeFeed speed = rapid ? GcodeFeed{} : feed();
  if (corner_ && !rapid && !tables) {
    cut_corner(to);
  } else {
    require_no_corner("G0");
    release_corner();
  }
  if (!corner.any() || rapid || tables || feed_mode_ == FeedMode::kInverse) {
    if (corner.own && corner.any())
      throw ProgramFault{"RND", "RND, CHF and CHR require a line (G1) of X, Y and Z"};
    return go_straight(to, named, rapid, speed);
  }
  corner.at = to;
  corner.named = named;
  corner.feed = speed;
  corner_ = corner;
}

void SinumerikMachine::go_straight(const GcodeAxes& to, const Named& named, bool rapid,
                                   const GcodeFeed& speed) {
  if (compensation_.active()) {
    const PlanePoint at = in_plane(linear(frame_.programmed(at_)), plane_);
    return stand_beside(to, compensation_.straight(rapid, at, in_plane(linear(to), plane_),
                                                   info_of(to, named, speed)));
  }
  const GcodePlace end = place(to);
  if (rapid) {
    canon_.rapid(end, GcodeRapid::kPlain, named);
  } else {
    canon_.feed(end, speed, named);
  }
  at_ = end.axes;
}

void SinumerikMachine::go_round(const GcodeAxes& to, const Named& named, PlanePoint middle,
                                bool clockwise, int turns, const GcodeFeed& speed) {
  if (compensation_.active()) {
    const PlanePoint at = in_plane(linear(frame_.programmed(at_)), plane_);
    const ArcCenter center{.ijk = from_plane(middle, plane_), .absolute = true};
    return stand_beside(
        to, compensation_.arc(at, in_plane(linear(to), plane_), center, clockwise, turns,
                              kSpiralToleranceMm, info_of(to, named, speed)));
  }
  const Vec3 from = linear(programmed());
  const GcodePlace end = place(to);
  canon_.arc(arc_about(from, linear(to), plane_, middle, clockwise ? -turns : turns), frame_, end,
             speed, named);
  at_ = end.axes;
}

// I J K from the start, or I=AC(…); CR=, negative for more than half a circle.
PlanePoint SinumerikMachine::center(Words& words, Vec3 from, Vec3 to, bool& clockwise) {
  clockwise = motion_ == Motion::kClockwise;
  ArcCenter given;
  if (const SinumerikWord* radius = take(words, "CR")) given.radius = radius->value * unit_mm_;
  constexpr std::string_view kNames[] = {"I", "J", "K"};
  bool any = given.radius.has_value();
  for (std::size_t i = 0; i < 3; ++i) {
    const SinumerikWord* word = take(words, kNames[i]);
    if (word == nullptr) continue;
    any = true;
    const bool absolute = word->how == SinumerikWord::How::kAbsolute;
    part(given.ijk, i) = word->value * unit_mm_ - (absolute ? part(from, i) : 0);
  }
  if (!any)
    throw ProgramFault{"G" + std::to_string(static_cast<int>(motion_)),
                       "requires a center (I J K) or a radius (CR=); AR= and polar coordinates are "
                       "not supported"};
  return arc_center(from, to, plane_, given, clockwise);
}

// CIP: the circle through I1= J1= K1= in the plane.
PlanePoint SinumerikMachine::through(Words& words, Vec3 from, Vec3 to, bool& clockwise) {
  Vec3 middle = from;
  constexpr std::string_view kNames[] = {"I1", "J1", "K1"};
  for (std::size_t i = 0; i < 3; ++i) {
    const SinumerikWord* word = take(words, kNames[i]);
    if (word == nullptr) continue;
    const bool adds = word->how == SinumerikWord::How::kIncremental ||
                      (word->how == SinumerikWord::How::kModal && incremental_);
    part(middle, i) = word->value * unit_mm_ + (adds ? part(from, i) : 0);
  }
  const PlanePoint a = in_plane(from, plane_), b = in_plane(middle, plane_),
                   c = in_plane(to, plane_);
  if (std::abs(b.normal - a.normal) > 1e-6 || std::abs(c.normal - a.normal) > 1e-6)
    throw ProgramFault{"CIP", "whose circle is not parallel to the plane is not supported"};
  const double bx = b.first - a.first, by = b.second - a.second;
  const double cx = c.first - a.first, cy = c.second - a.second;
  const double area = bx * cy - by * cx;
  const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  if (!(std::abs(area) > 1e-9 * (b2 + c2)))
    throw ProgramFault{"CIP", "requires three points that are not on a line"};
  clockwise = area < 0;
  return {a.first + (cy * b2 - by * c2) / (2 * area), a.second + (bx * c2 - cx * b2) / (2 * area),
          a.normal};
}

void SinumerikMachine::arc(Words& words, const GcodeAxes& to, const Named& named) {
  const Vec3 from = linear(programmed()), end = linear(to);
  bool clockwise = false;
  const PlanePoint middle = motion_ == Motion::kThroughPoint ? through(words, from, end, clockwise)
                                                             : center(words, from, end, clockwise);
  int turns = 1;
  if (const SinumerikWord* word = take(words, "TURN")) {
    if (!(word->value >= 0 && word->value <= kTurnsMax && word->value == std::floor(word->value)))
      throw ProgramFault{"TURN", "must be an integer from 0 to 1000"};
    turns += static_cast<int>(word->value);
  }
  go_round(to, named, middle, clockwise, turns, feed());
}

// SUPA, G53, G153, G74 and G75: to a machine position, which is unknown in the workpiece.
void SinumerikMachine::go_to_machine(Words& words) {
  refuse_compensated("SUPA");
  Named named{};
  for (SinumerikWord& word : words) {
    const std::size_t axis = word.name.empty() ? std::string_view::npos : kAxes.find(word.name[0]);
    const bool is_axis = word.name.size() == 1 || (word.name.size() == 2 && word.name[1] == '1');
    if (!is_axis || axis == std::string_view::npos || word.kind != SinumerikWord::Kind::kValue)
      continue;
    named[axis] = word.used = true;
    if (axis >= 3) at_[axis] = word.name.size() == 1 ? word.value : 0;
  }
  if (std::ranges::find(named, true) == named.end()) return;
  canon_.rapid({at_, axis_}, GcodeRapid::kMachine, named);
}

// G4 F… in seconds, G4 S… in turns of the spindle.
void SinumerikMachine::dwell(Words& words) {
  require_no_corner("G4");
  release_corner();
  const auto rest = [this](double s) {
    CompensatedInfo info;
    info.line = line_;
    compensation_.dwell(std::max(0.0, s), info);
  };
  if (const SinumerikWord* seconds = take(words, "F")) {
    rest(seconds->value);
  } else if (const SinumerikWord* turns = take(words, "S")) {
    rest(rpm_ > 0 ? 60 * turns->value / rpm_ : 0);
  } else {
    throw ProgramFault{"G4", "requires F, seconds, or S, turns of the spindle"};
  }
}

}  // namespace kerf
