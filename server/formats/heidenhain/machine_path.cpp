// SPDX-License-Identifier: Apache-2.0
// Path functions of KlartextMachine: lines, arcs and corners.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "server/formats/control/arc.h"
#include "server/formats/heidenhain/machine.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr double kSamePointMm = 1e-6;
/// Greatest difference of an arc's radii at its ends, mm. Ends are written with three decimals.
constexpr double kRadiusDifferenceMm = 0.02;
constexpr double kTurnsMax = 1000;
constexpr std::string_view kAxes = "XYZ";

double& part(Vec3& v, std::size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

}  // namespace

const KlartextWord* KlartextMachine::find(const Words& words, const std::string& name) {
  for (const KlartextWord& word : words)
    if (word.name == name) return &word;
  return nullptr;
}

double KlartextMachine::mm(const KlartextWord& word) const {
  return values_.of(word.value) * unit_mm_;
}

double KlartextMachine::feed() const {
  if (!feed_ || !(*feed_ > 0)) throw ProgramFault{"", "the feed is missing; program F before it"};
  return *feed_;
}

bool KlartextMachine::clockwise(const Words& words) {
  const KlartextWord* word = find(words, "DR");
  if (word == nullptr || (word->value != "+" && word->value != "-"))
    throw ProgramFault{"DR", "the direction DR+ or DR- is missing"};
  return word->value == "-";
}

// The end of the path, including a delayed line.
Vec3 KlartextMachine::place() const { return corner_ ? corner_->at : path_.position(); }

// X, Y, Z and IX, IY, IZ. Other axes keep their values.
Vec3 KlartextMachine::target(const Words& words, std::array<bool, 3>& named) const {
  const bool moves_level = find(words, "X") != nullptr || find(words, "Y") != nullptr ||
                           find(words, "IX") != nullptr || find(words, "IY") != nullptr;
  const Vec3 at = moves_level && !corner_ ? path_.contour() : place();
  Vec3 to = at;
  for (const KlartextWord& word : words) {
    const bool incremental = word.name.size() == 2 && word.name[0] == 'I';
    if (word.name.empty() || word.name.size() > (incremental ? 2U : 1U)) continue;
    const std::size_t axis = kAxes.find(word.name.back());
    if (axis == std::string_view::npos) continue;
    Vec3 from = at;
    part(to, axis) = mm(word) + (incremental ? part(from, axis) : 0);
    named[axis] = true;
  }
  return to;
}

RotaryAngles KlartextMachine::rotary_target(const Words& words, bool& turns) {
  RotaryAngles to = path_.angles();
  for (const KlartextWord& word : words) {
    const bool incremental = word.name.size() == 2 && word.name[0] == 'I';
    const char axis = word.name.empty() ? ' ' : word.name.back();
    if (word.name.size() > (incremental ? 2U : 1U)) continue;
    double* const angle = axis == 'A' ? &to.a : axis == 'B' ? &to.b : axis == 'C' ? &to.c : nullptr;
    if (angle == nullptr) continue;
    const MachineKinematics kind = scene_.machine.kinematics;
    const bool has = axis == 'C' ? has_rotary_table(kind)
                                 : kind == (axis == 'A' ? MachineKinematics::kXyzacTrt
                                                        : MachineKinematics::kXyzbcTrt);
    if (!has)
      throw ProgramFault{word.name + word.value, "the machine " + std::string(to_string(kind)) +
                                                     " has no " + axis + " axis"};
    if (path_.is_tilted())
      throw ProgramFault{word.name + word.value,
                         "turns an axis in a tilted plane, which is not "
                         "supported"};
    const double value = values_.of(word.value);
    if (shortest_ && incremental && std::abs(value) > 180)
      throw ProgramFault{word.name + word.value, "turns by more than 180 degrees with M126"};
    // With M126 the previous angle is counted such that the turn is the shorter one.
    if (shortest_ && !incremental) path_.count_angle(axis, value);
    *angle = value + (incremental ? *angle : 0);
    turns = true;
  }
  return to;
}

void KlartextMachine::move(Vec3 to, std::optional<double> feed, std::array<bool, 3> named) {
  const Vec3 path = to - path_.position();
  if (length(path) > kSamePointMm) direction_ = normalized(path);
  path_.line(to, path_.angles(), feed, named);
}

void KlartextMachine::move_arc(Vec3 to, ArcPlane plane, Vec3 center, int turns) {
  if (corner_) throw ProgramFault{"RND", "beside an arc is not supported; write the arc"};
  const double f = feed();
  const PlanePoint end = in_plane(to, plane), middle = in_plane(center, plane);
  const double x = end.first - middle.first, y = end.second - middle.second;
  path_.arc(to, plane, center, turns, f);
  const double side = turns > 0 ? 1 : -1;
  const Vec3 tangent = from_plane({-side * y, side * x, 0}, plane);
  if (length(tangent) > kSamePointMm) direction_ = normalized(tangent);
}

void KlartextMachine::linear(const Words& words, const Extras& extras, bool corner_follows) {
  for (const KlartextWord& word : words) {
    const std::size_t sign = word.name.starts_with('I') ? 1 : 0;
    const bool axis = word.name.size() == sign + 1 &&
                      std::string_view("XYZABC").find(word.name.back()) != std::string_view::npos;
    if (!axis || word.value.empty())
      throw ProgramFault{word.name + word.value, "is not a word of L"};
  }
  if (extras.in_machine) return to_machine(words, extras);
  std::array<bool, 3> named{};
  bool turns = false;
  const RotaryAngles angles = rotary_target(words, turns);
  const Vec3 to = target(words, named);
  if (!turns) {
    if (named[0] || named[1] || named[2]) straight(to, extras, named, corner_follows);
    return;
  }
  refuse_in_corner("A, B and C");
  if (corner_follows && !extras.rapid)
    throw ProgramFault{"RND", "behind a line that turns an axis is not supported"};
  direction_.reset();
  path_.line(to, angles, extras.rapid ? std::nullopt : std::optional(feed()), named);
}

// Removes TX TY TZ or NX NY NZ from a block and returns them as a unit vector of the workpiece.
std::optional<Vec3> KlartextMachine::take_vector(Words& words, char kind) const {
  Vec3 vector{0, 0, 0};
  int count = 0;
  std::erase_if(words, [&](const KlartextWord& word) {
    if (word.name.size() != 2 || word.name[0] != kind || word.value.empty()) return false;
    const std::size_t axis = kAxes.find(word.name[1]);
    if (axis == std::string_view::npos) return false;
    part(vector, axis) = values_.of(word.value);
    ++count;
    return true;
  });
  if (count == 0) return std::nullopt;
  const KlartextFrame& frame = path_.frame();
  const Vec3 turned = frame.in_workpiece(vector) - frame.datum_mm;
  if (count != 3 || !(length(turned) > kVectorMin))
    throw ProgramFault{std::string("LN"), std::string("requires all of ") + kind + "X, " + kind +
                                              "Y and " + kind + "Z, a vector other than 0"};
  return normalized(turned);
}

// LN X Y Z TX TY TZ NX NY NZ with M128: a line during which the tool turns to T. Without T it turns
// to the surface normal N, which otherwise would only displace an oversized tool.
void KlartextMachine::linear_with_vectors(Words words, const Extras& extras) {
  refuse_in_corner("LN");
  if (path_.is_tilted() || path_.is_compensated())
    throw ProgramFault{"LN", "in a tilted plane or beside a contour (RL, RR) is not supported"};
  const std::optional<Vec3> tool = take_vector(words, 'T'), normal = take_vector(words, 'N');
  if ((tool || normal) && !path_.has_tool_center())
    throw ProgramFault{"LN", "with a vector requires M128 or FUNCTION TCPM"};
  for (const KlartextWord& word : words)
    if (word.value.empty() || kAxes.find(word.name.back()) == std::string_view::npos)
      throw ProgramFault{word.name + word.value, "is not a word of LN"};
  std::array<bool, 3> named{};
  const Vec3 to = target(words, named);
  const std::optional<double> speed = extras.rapid ? std::nullopt : std::optional(feed());
  direction_.reset();
  if (tool || normal) return path_.line(to, tool ? *tool : *normal, speed, named);
  path_.line(to, path_.angles(), speed, named);
}

// Moves to `to`, or delays the line because a corner follows.
void KlartextMachine::straight(Vec3 to, const Extras& extras, std::array<bool, 3> named,
                               bool corner_follows) {
  const std::optional<double> speed = extras.rapid ? std::nullopt : std::optional(feed());
  if (corner_) cut_corner(to);
  if (corner_follows && speed) {
    corner_ = Corner{.at = to, .feed = *speed, .own_feed = {}, .size = {}};
  } else {
    move(to, speed, named);
  }
}

// After M91 and M92 linear axes are unknown, because the workpiece's position in the machine is.
// Tables count from the machine zero, because no datum shift turns them.
void KlartextMachine::to_machine(const Words& words, const Extras& extras) {
  refuse_in_corner("M91");
  for (const KlartextWord& word : words)
    if (std::string_view("ABC").find(word.name.back()) != std::string_view::npos &&
        (extras.datum_of_builder || word.name.size() > 1))
      throw ProgramFault{word.name + word.value,
                         "beside M92, or incremental beside M91, is not supported"};
  std::array<bool, 3> named{};
  target(words, named);
  bool turns = false;
  const RotaryAngles angles = rotary_target(words, turns);
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (named[axis]) path_.lose(axis);
  if (!turns) return;
  const bool rapid = extras.rapid || named[0] || named[1] || named[2];
  direction_.reset();
  path_.line(path_.position(), angles, rapid ? std::nullopt : std::optional(feed()), {});
}

// RND and CHF between two lines. The first line is delayed.
void KlartextMachine::corner(const Words& words, bool chamfer) {
  if (!corner_) throw ProgramFault{chamfer ? "CHF" : "RND", "must stand behind a straight line"};
  for (const KlartextWord& word : words) {
    const bool size = word.name.empty() || word.name == "R";
    if (!size || word.value.empty())
      throw ProgramFault{word.name + word.value, "is not a word of RND and CHF"};
    (chamfer ? corner_->size.leg_mm : corner_->size.radius_mm) = mm(word);
  }
}

void KlartextMachine::cut_corner(Vec3 next) {
  const Corner corner = *std::exchange(corner_, std::nullopt);
  const std::array<bool, 3> named{true, true, true};
  const PlanePoint from = in_plane(path_.position(), ArcPlane::kXy);
  const PlanePoint at = in_plane(corner.at, ArcPlane::kXy), to = in_plane(next, ArcPlane::kXy);
  const auto cut = corner_path(from, at, to, corner.size, kSamePointMm);
  if (!cut && cut.error() == CornerFault::kNotLevel)
    throw ProgramFault{"RND", "is supported in the plane XY only"};
  if (distance(from, at) < kSamePointMm || distance(at, to) < kSamePointMm)
    throw ProgramFault{"RND", "requires a line before and a line behind it"};
  if (!cut) throw ProgramFault{"RND", "does not fit between its lines"};
  const bool chamfer = corner.size.leg_mm > 0;
  if (!chamfer && !(cut->center && corner.size.radius_mm > 0))
    return move(corner.at, corner.feed, named);
  move(from_plane(cut->start, ArcPlane::kXy), corner.feed, named);
  const Vec3 end = from_plane(cut->end, ArcPlane::kXy);
  const double feed_in_corner = corner.own_feed.value_or(corner.feed);
  if (chamfer) return move(end, feed_in_corner, named);
  path_.arc(end, ArcPlane::kXy, from_plane(*cut->center, ArcPlane::kXy), cut->turns,
            feed_in_corner);
}

void KlartextMachine::pole(const Words& words) {
  std::array<bool, 3> named{};
  const Vec3 at = target(words, named);
  const int count = named[0] + named[1] + named[2];
  if (count == 0) {
    pole_ = place();
    pole_plane_ = ArcPlane::kXy;
  } else if (count == 2) {
    pole_ = at;
    pole_plane_ = !named[2] ? ArcPlane::kXy : !named[1] ? ArcPlane::kZx : ArcPlane::kYz;
  } else {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (named[axis]) part(pole_, axis) = axis == 0 ? at.x : axis == 1 ? at.y : at.z;
  }
  pole_known_ = true;
}

void KlartextMachine::circle(const Words& words) {
  if (!pole_known_) throw ProgramFault{"C", "requires CC, the center"};
  const bool right = clockwise(words);
  std::array<bool, 3> named{};
  const Vec3 to = target(words, named);
  const PlanePoint a = in_plane(path_.position(), pole_plane_), b = in_plane(to, pole_plane_),
                   m = in_plane(pole_, pole_plane_);
  const double first = std::hypot(a.first - m.first, a.second - m.second);
  const double second = std::hypot(b.first - m.first, b.second - m.second);
  if (first < kSamePointMm || std::abs(first - second) > kRadiusDifferenceMm)
    throw ProgramFault{"", "the radius of the circle is " + std::to_string(first) +
                               " mm at its start but " + std::to_string(second) + " at its end"};
  if (std::abs(a.normal - b.normal) > kSamePointMm)
    throw ProgramFault{"C", "may not leave its plane; use CP for a helix"};
  move_arc(to, pole_plane_, pole_, right ? -1 : 1);
}

// CP PA+90 DR+, CP IPA+720 IZ-5 DR+.
void KlartextMachine::polar_circle(const Words& words) {
  if (!pole_known_) throw ProgramFault{"CP", "requires CC, the pole"};
  const bool right = clockwise(words);
  const PlanePoint a = in_plane(path_.position(), pole_plane_), m = in_plane(pole_, pole_plane_);
  const double x = a.first - m.first, y = a.second - m.second;
  const double radius = std::hypot(x, y);
  if (radius < kSamePointMm) throw ProgramFault{"CP", "begins at the pole"};
  const KlartextWord *by = find(words, "IPA"), *to_angle = find(words, "PA");
  double sweep = 0;
  if (by != nullptr) {
    sweep = values_.of(by->value);
    if (sweep != 0 && (sweep < 0) != right)
      throw ProgramFault{"IPA", "turns against DR; both must have the same sign"};
  } else if (to_angle != nullptr) {
    sweep = std::fmod(values_.of(to_angle->value) - kDegPerRad * std::atan2(y, x), 360.0);
    if (right && sweep >= -1e-9) sweep -= 360;
    if (!right && sweep <= 1e-9) sweep += 360;
  } else {
    throw ProgramFault{"CP", "requires PA or IPA, the angle"};
  }
  if (std::abs(sweep) > 360 * kTurnsMax || sweep == 0)
    throw ProgramFault{"IPA", "must be an angle other than 0 of at most 1000 turns"};
  const double turn = kRadPerDeg * sweep;
  PlanePoint end{m.first + x * std::cos(turn) - y * std::sin(turn),
                 m.second + x * std::sin(turn) + y * std::cos(turn), a.normal};
  const double whole = std::abs(sweep) / 360;
  int turns = static_cast<int>(std::ceil(whole - 1e-9));
  if (std::abs(whole - std::round(whole)) < 1e-9) end = {a.first, a.second, a.normal};
  std::array<bool, 3> named{};
  const Vec3 lifted = target(words, named);
  end.normal = in_plane(lifted, pole_plane_).normal;
  move_arc(from_plane(end, pole_plane_), pole_plane_, pole_, right ? -turns : turns);
}

void KlartextMachine::polar_line(const Words& words, const Extras& extras, bool corner_follows) {
  if (!pole_known_) throw ProgramFault{"LP", "requires CC, the pole"};
  const PlanePoint a = in_plane(place(), pole_plane_), m = in_plane(pole_, pole_plane_);
  const double x = a.first - m.first, y = a.second - m.second;
  double radius = std::hypot(x, y), angle = kDegPerRad * std::atan2(y, x);
  for (const KlartextWord& word : words) {
    if (word.name == "PR") radius = mm(word);
    if (word.name == "IPR") radius += mm(word);
    if (word.name == "PA") angle = values_.of(word.value);
    if (word.name == "IPA") angle += values_.of(word.value);
  }
  std::array<bool, 3> named{};
  const Vec3 lifted = target(words, named);
  const Vec3 to = from_plane(
      {m.first + radius * std::cos(kRadPerDeg * angle),
       m.second + radius * std::sin(kRadPerDeg * angle), in_plane(lifted, pole_plane_).normal},
      pole_plane_);
  straight(to, extras, {true, true, named[2]}, corner_follows);
}

// CR X Y R+10 DR-: R above 0 is the arc of at most 180 degrees.
void KlartextMachine::circle_by_radius(const Words& words) {
  const bool right = clockwise(words);
  const KlartextWord* radius = find(words, "R");
  if (radius == nullptr) throw ProgramFault{"CR", "requires R, the radius"};
  std::array<bool, 3> named{};
  const Vec3 from = path_.position(), to = target(words, named);
  if (std::abs(from.z - to.z) > kSamePointMm)
    throw ProgramFault{"CR", "is supported in the plane XY only"};
  ArcCenter center;
  center.radius = mm(*radius);
  const PlanePoint middle = arc_center(from, to, ArcPlane::kXy, center, right);
  move_arc(to, ArcPlane::kXy, from_plane({middle.first, middle.second, from.z}, ArcPlane::kXy),
           right ? -1 : 1);
}

// The arc that continues in the direction of the path.
void KlartextMachine::tangent_circle(const Words& words) {
  std::array<bool, 3> named{};
  const Vec3 from = path_.position(), to = target(words, named);
  if (!direction_ || std::abs(direction_->z) > 1e-9 || std::abs(from.z - to.z) > kSamePointMm)
    throw ProgramFault{"CT", "requires a path in the plane XY before it"};
  const Vec3 chord = to - from;
  const double size = length(chord);
  if (size < kSamePointMm) throw ProgramFault{"CT", "ends at its start"};
  const Vec3 normal{-direction_->y, direction_->x, 0};
  const double across = dot(chord, normal);
  if (std::abs(across) < 1e-9 * size) return move(to, feed(), {true, true, true});
  const double radius = size * size / (2 * across);
  move_arc(to, ArcPlane::kXy, from + normal * radius, radius > 0 ? 1 : -1);
}

}  // namespace kerf
