// SPDX-License-Identifier: Apache-2.0
// Motions of AptMachine: points, arcs and holes.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernel/math/rotation.h"
#include "server/formats/apt/machine.h"
#include "server/formats/control/arc.h"
#include "server/formats/machine_kinematics.h"
#include "server/formats/number_text.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

// Least length of a vector with a direction.
constexpr double kAxisLengthMin = 1e-6;
// Radii at the ends of an arc may differ by this share and this length, because points are rounded.
constexpr double kRadiusShare = 1e-3, kRadiusMm = 0.03;
// Ends of an arc nearer than this, mm, are equal: a full circle.
constexpr double kSamePointMm = 1e-6;

// Coordinates in the plane of a circle: along u, along v = n x u, along the normal n.
struct Plane {
  Vec3 center, u, v, n;
  Vec3 local(Vec3 p) const {
    const Vec3 d = p - center;
    return {dot(d, u), dot(d, v), dot(d, n)};
  }
  Vec3 world(Vec3 p) const { return center + u * p.x + v * p.y + n * p.z; }
};

Plane plane_of(Vec3 center, Vec3 axis, Vec3 start) {
  const Vec3 d = start - center;
  const Vec3 u = normalized(d - axis * dot(d, axis));
  return {center, u, cross(axis, u), axis};
}

double planar_radius(const Plane& plane, Vec3 p) {
  const Vec3 local = plane.local(p);
  return std::hypot(local.x, local.y);
}

// The numbers of "(CIRCLE/1,2,3,4)" in a text.
std::vector<double> numbers_of(const std::string& text, std::string_view opening) {
  std::vector<double> numbers;
  const std::size_t begin = text.find(opening);
  if (begin == std::string::npos) return numbers;
  std::size_t at = begin + opening.size();
  const std::size_t end = std::min(text.find(')', at), text.size());
  while (at < end) {
    const std::size_t comma = std::min(text.find(',', at), end);
    numbers.push_back(apt_number_of(text.substr(at, comma - at)));
    at = comma + 1;
  }
  return numbers;
}

}  // namespace

void AptMachine::check(const MotionSink::Result& result) {
  if (!result) throw ProgramFault{"", result.error()};
}

Vec3 AptMachine::read_axis(const AptStatement& s, std::size_t first) const {
  const Vec3 axis{apt_number_of(s.minor[first]), apt_number_of(s.minor[first + 1]),
                  apt_number_of(s.minor[first + 2])};
  const double size = length(axis);
  if (!(size > kAxisLengthMin) || !std::isfinite(size))
    throw ProgramFault{s.major, "the axis i,j,k must be a finite vector other than 0,0,0"};
  return axis;
}

void AptMachine::check_tilt(Vec3 axis) const {
  const bool tilted = axis.x != 0 || axis.y != 0 || axis.z < 0;
  if (tilted && scene_.machine.kinematics == MachineKinematics::kXyz)
    throw ProgramFault{"", "tilts the tool, which the scene's machine xyz cannot do"};
}

// GOTO/x,y,z or x,y,z,i,j,k. Three more are the normal of the surface.
ToolPose AptMachine::read_pose(const AptStatement& s) const {
  const std::size_t count = s.minor.size();
  if (count != 3 && count != 6 && count != 9)
    throw ProgramFault{s.major, "has " + std::to_string(count) +
                                    " values; it takes x,y,z or x,y,z,i,j,k, and then a normal"};
  ToolPose pose{{apt_number_of(s.minor[0]) * unit_mm_, apt_number_of(s.minor[1]) * unit_mm_,
                 apt_number_of(s.minor[2]) * unit_mm_},
                axis_};
  if (count > 3) {
    pose.axis = read_axis(s, 3);
    check_tilt(pose.axis);
  }
  return pose;
}

void AptMachine::tool_axis(const AptStatement& s) {
  if (s.minor.size() < 3) throw ProgramFault{s.major, "requires i,j,k"};
  const Vec3 axis = read_axis(s, 0);
  check_tilt(axis);
  axis_ = axis;
}

void AptMachine::from(const AptStatement& s) {
  const ToolPose pose = read_pose(s);
  check(sink_.place(pose));
  axis_ = pose.axis;
}

void AptMachine::go_to(const AptStatement& s) {
  if (s.minor.size() == 1 && s.minor[0] == "HOME") return go_home(s);
  const ToolPose pose = read_pose(s);
  if (circle_) {
    const Circle circle = *circle_;
    circle_.reset();
    if (s.creo) last_circle_ = circle;
    require_tool();
    if (!sink_.placed()) throw ProgramFault{"CIRCLE", "requires a position before it"};
    return arc(circle, pose);
  }
  // Creo writes further points of a circle after the first one.
  if (last_circle_ && sink_.placed() && !rapid_) {
    const Plane plane = plane_of(last_circle_->center_mm, last_circle_->axis, sink_.last()->tip_mm);
    const double radius = planar_radius(plane, sink_.last()->tip_mm);
    const double off = std::abs(planar_radius(plane, pose.tip_mm) - radius);
    if (off <= kRadiusMm && off <= kRadiusShare * radius) return arc(*last_circle_, pose);
    last_circle_.reset();
  }
  if (cycle_) return hole(pose);
  move(pose);
}

void AptMachine::go_delta(const AptStatement& s) {
  if (!sink_.placed()) throw ProgramFault{s.major, "requires FROM or GOTO before it"};
  ToolPose pose = *sink_.last();
  if (s.minor.size() == 1) {
    pose.tip_mm = pose.tip_mm + normalized(pose.axis) * (apt_number_of(s.minor[0]) * unit_mm_);
  } else if (s.minor.size() == 3) {
    pose.tip_mm = pose.tip_mm + Vec3{apt_number_of(s.minor[0]), apt_number_of(s.minor[1]),
                                     apt_number_of(s.minor[2])} *
                                    unit_mm_;
  } else {
    throw ProgramFault{s.major, "has " + std::to_string(s.minor.size()) +
                                    " values; it takes 3, or 1 along the axis"};
  }
  move(pose);
}

void AptMachine::go_home(const AptStatement&) {
  sink_.lift();
  rapid_ = false;
}

// CIRCLE/x,y,z,i,j,k,…: center and axis, about which the next GOTO is reached counterclockwise.
void AptMachine::circle(const AptStatement& s) {
  if (s.minor.size() < 6)
    throw ProgramFault{s.major, "has " + std::to_string(s.minor.size()) +
                                    " values; it takes the center x,y,z and the axis i,j,k"};
  if (std::ranges::find(s.minor, "TIMES") != s.minor.end())
    throw ProgramFault{"TIMES", "winds the arc more than once, which is not supported"};
  circle_ =
      Circle{Vec3{apt_number_of(s.minor[0]), apt_number_of(s.minor[1]), apt_number_of(s.minor[2])} *
                 unit_mm_,
             normalized(read_axis(s, 3))};
  rapid_ = false;
}

void AptMachine::direction(const AptStatement& s) {
  if (s.minor.size() != 3) throw ProgramFault{s.major, "requires i,j,k"};
  direction_ = read_axis(s, 0);
}

// CATIA: INDIRV/i,j,k and TLON,GOFWD/(CIRCLE/x,y,z,r),ON,2,INTOF,(LINE/x,y,z,x,y,z): the arc in XY
// that begins in the direction of INDIRV and ends on the line, which comes from the center.
void AptMachine::circle_to_line(const AptStatement& s) {
  std::string text;
  for (const std::string& word : s.minor) text += (text.empty() ? "" : ",") + word;
  const auto ring = numbers_of(text, "(CIRCLE/"), line = numbers_of(text, "(LINE/");
  if (ring.size() != 4 || line.size() != 6) refuse(s);
  if (!direction_ || !sink_.placed())
    throw ProgramFault{s.major, "requires INDIRV and a position before it"};
  const Vec3 center = Vec3{ring[0], ring[1], ring[2]} * unit_mm_;
  const Vec3 to = Vec3{line[3], line[4], line[5]} * unit_mm_;
  const Vec3 start = sink_.last()->tip_mm - center;
  const double turn = start.x * direction_->y - start.y * direction_->x;
  const double radius = ring[3] * unit_mm_;
  if (std::abs(turn) < kRadiusShare * std::hypot(start.x, start.y) * length(*direction_))
    throw ProgramFault{"INDIRV", "points to or from the center of the circle"};
  if (std::abs(std::hypot(to.x - center.x, to.y - center.y) - radius) > kRadiusMm)
    throw ProgramFault{"LINE", "does not end on the circle"};
  require_tool();
  const Vec3 up{0, 0, 1};
  arc(Circle{center, turn > 0 ? up : -up}, ToolPose{to, axis_});
}

void AptMachine::require_tool() {
  if (!sink_.tool()) {
    if (scene_.tools.size() != 1)
      throw ProgramFault{"", "no tool is loaded and the scene has several; load one with LOADTL"};
    warn_once("no tool is loaded; the scene's only tool is used");
    sink_.set_tool(scene_.tools.begin()->first);
  }
  check_cutter();
}

void AptMachine::move(const ToolPose& to) {
  require_tool();
  straight(to, rapid_);
  rapid_ = false;
}

void AptMachine::straight(const ToolPose& to, bool rapid) {
  // A rapid to another side of the workpiece goes around it, by a path that only the post-processor
  // knows.
  const bool around =
      rapid && sink_.placed() &&
      angle_between(normalized(sink_.last()->axis), normalized(to.axis)) > kTurnMaxRad;
  if (!sink_.placed() || around) {
    check(sink_.place(to));
  } else {
    check(sink_.line(to, duration_s(*sink_.last(), to, rapid), rapid, line_));
  }
  axis_ = to.axis;
}

void AptMachine::arc(Circle circle, ToolPose to) {
  const ToolPose from = *sink_.last();
  const Plane plane = plane_of(circle.center_mm, circle.axis, from.tip_mm);
  const double r0 = planar_radius(plane, from.tip_mm), r1 = planar_radius(plane, to.tip_mm);
  if (!(r0 > kSamePointMm) || std::abs(r0 - r1) > std::max(kRadiusMm, kRadiusShare * r0))
    throw ProgramFault{"CIRCLE", "the radius of the arc is " + decimal_text(r0, 4) +
                                     " mm at its start and " + decimal_text(r1, 4) + " at its end"};
  const Vec3 start = plane.local(from.tip_mm);
  Vec3 end = plane.local(to.tip_mm);
  if (std::hypot(end.x - start.x, end.y - start.y) < kSamePointMm) end.x = start.x, end.y = start.y;
  const Arc path = arc_about(start, end, ArcPlane::kXy, PlanePoint{}, 1);
  const int chords = path.chords(scene_.settings.tolerance_mm);
  if (chords > kPiecesMax) throw ProgramFault{"CIRCLE", "has too many chords"};
  const auto at = [path, plane, from, to](double s) {
    if (s >= 1) return to;
    return ToolPose{plane.world(path.at(s)),
                    normalized(normalized(from.axis) * (1 - s) + normalized(to.axis) * s)};
  };
  check(sink_.chords(at, chords, 60 * path.length_mm() / feed_mm_per_min(feed_), false, line_));
  axis_ = to.axis;
}

// CYCLE/DRILL,FEDTO,d,MMPM,f,RAPTO,r,RTRCTO,t,DWELL,s drills a hole at each GOTO until CYCLE/OFF.
void AptMachine::cycle(const AptStatement& s) {
  const std::string kind = s.minor.empty() ? std::string() : s.minor[0];
  if (kind == "OFF" || kind == "NOMORE" || kind == "INIT") return cycle_.reset();
  if (kind == "ON" || kind == "CLEAR") return;
  Cycle cycle;
  cycle.feed = feed_;
  bool deep = false;
  for (std::size_t i = 1; i < s.minor.size(); ++i) {
    const std::string& word = s.minor[i];
    double unit = unit_mm_;
    Feed feed = cycle.feed;
    const bool is_feed = take_feed_unit(word, feed, unit);
    if (apt_number(word))
      throw ProgramFault{word, "has no word before it that says what it is, as FEDTO, RAPTO, MMPM"};
    const auto value = i + 1 < s.minor.size() ? apt_number(s.minor[i + 1]) : std::nullopt;
    const bool automatic = i + 1 < s.minor.size() && s.minor[i + 1] == "AUTO";
    if (value || automatic) ++i;
    if (!value) {
      if (!automatic && word != "AUTO") warn_once("CYCLE/" + word + " is left out");
    } else if (is_feed) {
      feed.written = *value;
      feed.mm = *value * unit;
      cycle.feed = feed;
    } else if (word == "FEDTO" || word == "DEPTH") {
      cycle.depth_mm = std::abs(*value) * unit_mm_;
      deep = true;
    } else if (word == "RAPTO" || word == "CLEAR") {
      cycle.approach_mm = *value * unit_mm_;
    } else if (word == "RTRCTO" || word == "RETURN") {
      cycle.retract_mm = *value * unit_mm_;
    } else if (word == "DWELL") {
      cycle.dwell_s = *value;
    } else if (word != "INCR" && word != "STEP" && !word.ends_with("PECK")) {
      warn_once("CYCLE/" + word + " is left out");
    }
  }
  if (!deep) throw ProgramFault{"CYCLE/" + kind, "requires FEDTO or DEPTH, the depth of the hole"};
  cycle.start_mm = sink_.placed() ? dot(sink_.last()->tip_mm, normalized(axis_)) : 0;
  cycle_ = cycle;
}

void AptMachine::hole(const ToolPose& at) {
  require_tool();
  rapid_ = false;
  const Vec3 axis = normalized(at.axis);
  const double level = dot(at.tip_mm, axis);
  const double approach = std::max(cycle_->approach_mm, 0.0);
  const double high = std::max(approach, cycle_->retract_mm.value_or(cycle_->start_mm - level));
  const auto above = [&](double mm) { return ToolPose{at.tip_mm + axis * mm, at.axis}; };
  if (sink_.placed() && normalized(sink_.last()->axis) == axis) {
    // Up first, or across first: never down while moving across.
    const double now = dot(sink_.last()->tip_mm, axis) - level;
    ToolPose side = *sink_.last();
    if (now < high) side.tip_mm = side.tip_mm + axis * (high - now);
    straight(side, true);
    straight(above(std::max(now, high)), true);
  } else {
    straight(above(high), true);
  }
  straight(above(approach), true);
  const Feed before = feed_;
  feed_ = cycle_->feed;
  straight(above(-cycle_->depth_mm), false);
  if (cycle_->dwell_s > 0) check(sink_.dwell(cycle_->dwell_s, line_));
  feed_ = before;
  straight(above(high), true);
}

double AptMachine::feed_mm_per_min(const Feed& feed) const {
  if (feed.mm <= 0)
    throw ProgramFault{"", "the feed is 0; give FEDRAT before the first cutting motion"};
  if (feed.unit == FeedUnit::kPerMinute) return feed.mm;
  if (spindle_rpm_ <= 0)
    throw ProgramFault{"", "a feed per revolution requires a spindle speed; give SPINDL before it"};
  return feed.mm * spindle_rpm_;
}

double AptMachine::duration_s(const ToolPose& from, const ToolPose& to, bool rapid) const {
  const FeedTravel path = feed_travel(from, to);
  const double travel = path.length();
  if (rapid) return 60 * travel / scene_.machine.rapid_mm_per_min;
  const double per_min = feed_mm_per_min(feed_);
  // If only the axis turns, the feed is in degrees, as written.
  return 60 * travel / (path.mm > 0 ? per_min : per_min * feed_.written / feed_.mm);
}

}  // namespace kerf
