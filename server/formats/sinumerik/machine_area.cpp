// SPDX-License-Identifier: Apache-2.0
// Pockets, spigots and faces of SinumerikMachine: parameters as in Siemens, "Cycles", 840D/810D,
// chapter 3 (POCKET3, POCKET4, CYCLE71, CYCLE76, CYCLE77).
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/sinumerik/machine.h"

namespace kerf {
namespace {

/// Indices of a cycle's arguments, from 0, or -1 for a missing one. All begin with RTP, RFP, SDIS,
/// DP.
struct AreaCycle {
  std::string_view name;
  int dpr, length, width, corner, x, y, turn, infeed, side, floor, feed, plunge, variant, count;
  int blank_length, blank_width;
};
constexpr AreaCycle kAreaCycles[] = {
    {"POCKET3", -1, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 16, 23, -1, -1},
    {"POCKET4", -1, 4, -1, -1, 5, 6, -1, 7, 8, 9, 10, 11, 13, 19, -1, -1},
    {"CYCLE71", -1, 6, 7, -1, 4, 5, 8, 9, -1, 12, 13, -1, 14, 16, -1, -1},
    {"CYCLE76", 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 17, 20, 18, 19},
    {"CYCLE77", 4, 5, -1, -1, 6, 7, -1, 8, 9, 10, 11, 12, 14, 16, 15, -1}};
/// CYCLE71: default infeed across, as a share of the tool's diameter.
constexpr double kFaceShare = 0.8;

AreaPath taken(AreaResult result, std::string_view cycle) {
  if (!result) throw ProgramFault{std::string(cycle), result.error()};
  return *std::move(result);
}

// Returns the path of a cycle about its center that leaves `side` at its walls.
AreaPath area_path_of(const AreaCycle& rule, const std::function<double(int)>& mm, int variant,
                      double tool, double side) {
  const std::string_view name = rule.name;
  const bool facing = name == "CYCLE71";
  const double width = rule.width >= 0 ? mm(rule.width) : mm(rule.length);
  if (facing) {
    const double given_step = std::abs(mm(10));
    const int strokes = variant / 10;
    return taken(face(mm(rule.length), width, strokes != 2 && strokes != 4, tool,
                      given_step > 0 ? given_step : 2 * kFaceShare * tool),
                 name);
  }
  if (name == "POCKET3" || name == "POCKET4") {
    // PRAD is a radius.
    const double twice = name == "POCKET4" ? 2 : 1;
    const RoundedRectangle pocket{
        twice * mm(rule.length) - 2 * side, twice * width - 2 * side,
        name == "POCKET4" ? mm(rule.length) - side : std::max(0.0, mm(rule.corner) - side)};
    return taken(clear_pocket(pocket, tool, tool), name);
  }
  const double corner = name == "CYCLE77" ? mm(rule.length) / 2 : mm(rule.corner);
  const RoundedRectangle stud{mm(rule.length) + 2 * side, width + 2 * side, corner + side};
  const double blank_length = std::max(stud.length, mm(rule.blank_length));
  const double blank_width =
      rule.blank_width >= 0 ? std::max(stud.width, mm(rule.blank_width)) : blank_length;
  const double blank_corner = name == "CYCLE77" ? blank_length / 2 : 0;
  return taken(mill_stud(stud, {blank_length, blank_width, blank_corner}, tool, tool), name);
}

}  // namespace

bool SinumerikMachine::area_statement(std::string_view name,
                                      const std::vector<std::optional<double>>& given) {
  const auto* rule = std::ranges::find(kAreaCycles, name, &AreaCycle::name);
  if (rule == std::end(kAreaCycles)) return false;
  const std::string word(name);
  const auto value = [&given](int at) {
    return at >= 0 && static_cast<std::size_t>(at) < given.size()
               ? given[static_cast<std::size_t>(at)].value_or(0)
               : 0.0;
  };
  const auto mm = [&](int at) { return value(at) * unit_mm_; };
  for (std::size_t i = static_cast<std::size_t>(rule->count); i < given.size(); ++i)
    if (given[i].value_or(0) != 0)
      throw ProgramFault{word, "with the arguments of later controls (modes) is not supported"};
  if (plane_ != ArcPlane::kXy) throw ProgramFault{word, "is supported in the plane XY (G17) only"};
  refuse_compensated(word);
  const bool facing = name == "CYCLE71";
  for (const int at : {rule->length, rule->width})
    if (at >= 0 && (value(at) == 0 || (!facing && value(at) < 0)))
      throw ProgramFault{word, "requires lengths above 0, which count from the center"};
  const auto variant = static_cast<int>(std::abs(value(rule->variant))) % 10;
  if (variant > 2) throw ProgramFault{word, "requires a machining type (VARI) of 1 or 2"};
  Area area;
  area.retract = mm(0);
  area.reference = mm(1);
  area.safety = std::abs(mm(2));
  if (rule->dpr < 0 || (given.size() > 3 && given[3])) {
    if (given.size() <= 3 || !given[3]) throw ProgramFault{word, "requires DP, the depth"};
    area.bottom = mm(3);
  } else {
    area.bottom = area.reference - std::abs(mm(rule->dpr));
  }
  if (!(area.bottom < area.reference))
    throw ProgramFault{word, "has a depth that is not below its reference plane"};
  const bool finishes = variant == 2;
  const double side = finishes ? 0 : std::abs(mm(rule->side));
  const double floor = finishes ? 0 : std::abs(mm(rule->floor));
  const double tool = tool_radius_mm(word);
  const AreaPath path =
      area_path_of(*rule, mm, static_cast<int>(std::abs(value(rule->variant))), tool, side);
  const auto add = [&](const AreaPath& of, double level) {
    area.passes.emplace_back(placed(of, mm(rule->x), mm(rule->y), value(rule->turn)), level);
  };
  if (!finishes || facing) {
    const double infeed = finishes ? 0 : std::abs(mm(rule->infeed));
    for (const double level : pass_levels(area.reference, area.bottom + floor, infeed))
      add(path, level);
  } else {
    if (mm(rule->floor) != 0) add(path, area.bottom);
    if (mm(rule->side) != 0) add(last_loop(path), area.bottom);
  }
  if (value(rule->feed) > 0) area.feed = value(rule->feed) * feed_unit_mm_;
  area.plunge = value(rule->plunge) > 0 ? value(rule->plunge) * feed_unit_mm_ : area.feed;
  mill(area, word);
  return true;
}

// Each pass begins above the point where the last one descended.
void SinumerikMachine::mill(const Area& area, const std::string& word) {
  std::size_t moves = 0;
  for (const auto& pass : area.passes) moves += pass.first.size();
  if (moves > kAreaMovesMax)
    throw ProgramFault{word, "takes more than 100000 moves; state a larger infeed"};
  const GcodeFeed along =
      area.feed ? GcodeFeed{.mm_per_min = *area.feed, .deg_per_min = *area.feed} : feed();
  const GcodeFeed down =
      area.plunge ? GcodeFeed{.mm_per_min = *area.plunge, .deg_per_min = *area.plunge} : along;
  require_no_swivel();
  const double above = area.reference + area.safety;
  GcodeAxes to = programmed();
  const Named flat{true, true, false, false, false, false}, level{false, false, true};
  const auto rise = [&](double z) {
    to[2] = z;
    go_straight(to, level, true, {});
  };
  double before = area.reference;
  rise(std::max(to[2], above));
  for (const auto& [path, z] : area.passes) {
    to[0] = path[0].x;
    to[1] = path[0].y;
    go_straight(to, flat, true, {});
    rise(std::min(above, before + area.safety));
    to[2] = before = z;
    go_straight(to, level, false, down);
    for (std::size_t i = 1; i < path.size(); ++i) {
      const AreaMove& move = path[i];
      to[0] = move.x;
      to[1] = move.y;
      if (move.turns == 0) {
        go_straight(to, flat, false, along);
      } else {
        go_round(to, flat, {move.center_x, move.center_y, z}, move.turns < 0, 1, along);
      }
    }
    rise(above);
  }
  rise(std::max(above, area.retract));
}

}  // namespace kerf
