// SPDX-License-Identifier: Apache-2.0
// APPR and DEP of KlartextMachine: HEIDENHAIN, "Klartext Programming", TNC 640 and TNC7.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "server/formats/heidenhain/machine.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

using ApproachKind = KlartextApproach::Kind;

ApproachKind kind_of(const std::string& statement, const std::string& name) {
  if (name == "LT") return ApproachKind::kTangent;
  if (name == "LN") return ApproachKind::kNormal;
  if (name == "CT") return ApproachKind::kArc;
  if (name == "LCT") return ApproachKind::kLineAndArc;
  throw ProgramFault{statement + " " + name, "is not supported; LT, LN, CT and LCT are"};
}

}  // namespace

// Removes LEN, R and CCA from the words.
void KlartextMachine::approach_sizes(Words& words, KlartextApproach& to) const {
  bool has_length = false, has_radius = false, has_angle = false;
  std::erase_if(words, [&](const KlartextWord& word) {
    if (word.value.empty()) return false;
    const double value = values_.of(word.value);
    if (word.name == "LEN") to.length_mm = value * unit_mm_, has_length = true;
    if (word.name == "R") to.radius_mm = value * unit_mm_, has_radius = true;
    if (word.name == "CCA") to.angle_deg = value, has_angle = true;
    return word.name == "LEN" || word.name == "R" || word.name == "CCA";
  });
  const bool line = to.kind == ApproachKind::kTangent || to.kind == ApproachKind::kNormal;
  if (line && !(has_length && to.length_mm >= 0))
    throw ProgramFault{"LEN", "is missing or below 0"};
  if (!line && (!has_radius || to.radius_mm == 0))
    throw ProgramFault{"R", "of the arc is missing or 0"};
  if (to.kind == ApproachKind::kArc && !(has_angle && to.angle_deg > 0 && to.angle_deg <= 360))
    throw ProgramFault{"CCA", "must be above 0 and at most 360 degrees"};
}

void KlartextMachine::approach(const std::string& text) {
  const std::size_t end = std::min(text.find(' '), text.size());
  KlartextApproach to;
  to.kind = kind_of("APPR", text.substr(0, end));
  Words words = klartext_words(std::string_view(text).substr(end));
  std::erase_if(words, [&to](const KlartextWord& word) {
    if (word.value.empty() && word.name == "RL") to.side = 1;
    if (word.value.empty() && word.name == "RR") to.side = -1;
    return word.name == "RL" || word.name == "RR" || (word.name == "R" && word.value == "0");
  });
  const Extras extras = read_extras(words);
  if (extras.calls_cycle || extras.in_machine || extras.retract_mm)
    throw ProgramFault{"M", "of this kind beside APPR is not supported"};
  approach_sizes(words, to);
  if (to.side == 0 && to.kind != ApproachKind::kTangent)
    throw ProgramFault{"APPR", "requires RL or RR, on whose side the tool approaches"};
  check_departure_words(words);
  std::array<bool, 3> named{};
  to.contour = target(words, named);
  to.offset_mm = to.side == 0 || offsets_are_wear_ ? 0 : tool_radius_mm("APPR");
  to.feed = feed();
  to.is_rapid = extras.rapid;
  direction_.reset();
  path_.approach_later(to);
}

void KlartextMachine::check_departure_words(const Words& words) {
  for (const KlartextWord& word : words)
    if (word.value.empty() || word.name.empty() || word.name.size() > 2 ||
        (word.name.size() == 2 && word.name[0] != 'I') ||
        std::string_view("XYZ").find(word.name.back()) == std::string_view::npos)
      throw ProgramFault{word.name + word.value, "is not a word of APPR and DEP"};
}

// The tool departs from its offset position at the end of the contour.
void KlartextMachine::depart(const std::string& text) {
  const std::size_t end = std::min(text.find(' '), text.size());
  KlartextApproach from;
  from.kind = kind_of("DEP", text.substr(0, end));
  Words words = klartext_words(std::string_view(text).substr(end));
  from.side = path_.side();
  refuse_in_corner("DEP");
  std::erase_if(words, [](const KlartextWord& word) {
    return word.name == "R" && word.value == "0";  // DEP ends the compensation in any case
  });
  Words sizes = words;
  approach_sizes(sizes, from);
  std::erase_if(words, [](const KlartextWord& word) { return word.name == "R"; });
  std::erase_if(words,
                [](const KlartextWord& word) { return word.name == "LEN" || word.name == "CCA"; });
  const Extras extras = read_extras(words);
  if (extras.calls_cycle || extras.in_machine || extras.retract_mm || extras.rapid)
    throw ProgramFault{"DEP", "beside FMAX, M91, M99 and M140 is not supported"};
  check_departure_words(words);
  if (!words.empty() && from.kind != ApproachKind::kLineAndArc)
    throw ProgramFault{words[0].name + words[0].value, "is not a word of this DEP"};
  if (!direction_ || std::abs(direction_->z) > 1e-9)
    throw ProgramFault{"DEP", "requires a contour in the plane XY before it"};
  if (from.side == 0 && from.kind != ApproachKind::kTangent)
    throw ProgramFault{"DEP", "requires RL or RR, on whose side the tool leaves"};
  std::array<bool, 3> named{};
  const Vec3 target_at = target(words, named), t = *direction_;
  path_.compensate(0, 0);
  const Vec3 at = path_.position(), normal{-t.y, t.x, 0};
  if (from.kind == ApproachKind::kTangent)
    return move(at + t * from.length_mm, feed(), {true, true, false});
  if (from.kind == ApproachKind::kNormal)
    return move(at + normal * (from.side * from.length_mm), feed(), {true, true, false});
  const int turns = from.side * from.radius_mm > 0 ? 1 : -1;
  const Vec3 center = at + normal * (from.side * from.radius_mm);
  double angle = std::atan2(at.y - center.y, at.x - center.x) + turns * kRadPerDeg * from.angle_deg;
  const double radius = std::abs(from.radius_mm);
  if (from.kind == ApproachKind::kLineAndArc) {
    const Vec3 away{target_at.x - center.x, target_at.y - center.y, 0};
    if (!(length(away) >= radius))
      throw ProgramFault{"DEP LCT", "ends within its arc; state a smaller R"};
    angle = std::atan2(away.y, away.x) - turns * std::acos(radius / length(away));
  }
  move_arc({center.x + radius * std::cos(angle), center.y + radius * std::sin(angle), at.z},
           ArcPlane::kXy, center, turns);
  if (from.kind == ApproachKind::kLineAndArc) move(target_at, feed(), {true, true, named[2]});
}

// The center of the tool: to a point of the tangent, or of an arc, and on to the contour.
void KlartextPath::begin_contour(Vec3 tangent) {
  const KlartextApproach to = *std::exchange(approach_, std::nullopt);
  const double along = std::hypot(tangent.x, tangent.y);
  if (!(along > 0))
    throw ProgramFault{"APPR", "must be followed by a line or an arc in the plane XY"};
  const Vec3 t{tangent.x / along, tangent.y / along, 0}, normal{-t.y, t.x, 0};
  const std::vector<Lift> lifts = std::exchange(lifts_, {});
  Vec3 at = to.contour + normal * (to.side * to.offset_mm);
  if (!lifts.empty()) at.z = to.level;
  const auto go = [&](Vec3 end, bool rapid) {
    move_line(end, angles_, rapid ? std::nullopt : std::optional(to.feed), {true, true, true});
  };
  if (to.kind == ApproachKind::kDirect) {
    go(at, to.is_rapid);
  } else if (to.kind == ApproachKind::kTangent || to.kind == ApproachKind::kNormal) {
    const bool tangential = to.kind == ApproachKind::kTangent;
    go(tangential ? at - t * to.length_mm : at + normal * (to.side * to.length_mm), to.is_rapid);
    go(at, false);
  } else {
    const int turns = to.side * to.radius_mm > 0 ? 1 : -1;
    const double radius = std::abs(to.radius_mm);
    const Vec3 center = at + normal * (to.side * to.radius_mm);
    double angle = std::atan2(at.y - center.y, at.x - center.x) - turns * kRadPerDeg * to.angle_deg;
    if (to.kind == ApproachKind::kLineAndArc) {
      const Vec3 start = frame_.programmed(tip_mm_);
      const double x = start.x - center.x, y = start.y - center.y;
      if (!(std::hypot(x, y) >= radius))
        throw ProgramFault{"APPR LCT", "begins within its arc; state a smaller R"};
      angle = std::atan2(y, x) + turns * std::acos(radius / std::hypot(x, y));
    }
    go({center.x + radius * std::cos(angle), center.y + radius * std::sin(angle), at.z},
       to.is_rapid);
    move_arc(at, ArcPlane::kXy, center, turns, to.feed);
  }
  for (const Lift& lift : lifts) {
    at.z = lift.z;
    move_line(at, angles_, lift.feed, {false, false, true});
  }
  center_ = at;
  if (to.side != 0)
    compensation_.start_beside(to.side, to.offset_mm, ArcPlane::kXy,
                               in_plane(to.contour, ArcPlane::kXy));
}

}  // namespace kerf
