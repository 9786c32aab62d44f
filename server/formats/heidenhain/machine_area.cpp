// SPDX-License-Identifier: Apache-2.0
// Pockets, slots and studs (cycles 251 to 254, 256, 257), patterns (220, 221) and CYCL CALL POS of
// KlartextMachine: parameters as in HEIDENHAIN, "Cycle Programming", TNC 640.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/control/hole_pattern.h"
#include "server/formats/heidenhain/machine.h"

namespace kerf {
namespace {

/// The machining selected by Q215.
enum class Machining { kAll, kRoughing, kFinishing };

int count_of(const std::map<std::string, double>& given, const char* name) {
  const auto it = given.find(name);
  if (it == given.end() || !(it->second >= 1 && it->second <= kPatternHolesMax) ||
      it->second != std::floor(it->second))
    throw ProgramFault{name, "must be an integer from 1 to 10000"};
  return static_cast<int>(it->second);
}

AreaPath taken(AreaResult result, int cycle) {
  if (!result) throw ProgramFault{"CYCL DEF " + std::to_string(cycle), result.error()};
  return *std::move(result);
}

}  // namespace

bool KlartextMachine::is_area_cycle(int cycle) {
  return (cycle >= 251 && cycle <= 254) || cycle == 256 || cycle == 257;
}

// Position of the tool in a pocket or stud: Q367 0 is its center, 1 to 4 are the corners from lower
// left on; for a slot 1 to 4 are its left end, the centers of its ends, and its right end.
AreaPath KlartextMachine::area(double tool_mm, double allowance_mm) const {
  const auto mm_of = [this](const char* name) { return cycle_value(name, 0) * unit_mm_; };
  const double overlap = cycle_value("Q370", 1);
  const double step = (overlap > 0 ? overlap : 1) * tool_mm, less = 2 * allowance_mm;
  const int cycle = cycle_number_;
  const double at = cycle_value("Q367", 0);
  if (at != std::floor(at) || at < 0 || at > 4)
    throw ProgramFault{"Q367", "must be an integer from 0 to 4"};
  const auto place = static_cast<std::size_t>(at);
  if (cycle == 252) {
    const double size = mm_of("Q223") - less;
    return taken(clear_pocket({size, size, size / 2}, tool_mm, step), cycle);
  }
  if (cycle == 257) {
    const double size = mm_of("Q223") + less, blank = std::max(size, mm_of("Q222"));
    return taken(mill_stud({size, size, size / 2}, {blank, blank, blank / 2}, tool_mm, step),
                 cycle);
  }
  if (cycle == 254) {
    if (place != 0)
      throw ProgramFault{"Q367", "other than 0 is not supported in cycle 254; state the center"};
    return taken(clear_arc_slot({.radius = mm_of("Q375") / 2,
                                 .width = mm_of("Q219") - less,
                                 .first_deg = cycle_value("Q376", 0),
                                 .sweep_deg = cycle_value("Q248", 0)},
                                tool_mm, step),
                 cycle);
  }
  const double length = mm_of("Q218"), width = mm_of("Q219");
  if (cycle == 253) {
    if (length < width) throw ProgramFault{"Q218", "is less than the slot's width Q219"};
    const double along[] = {0, length / 2, (length - width) / 2, -(length - width) / 2,
                            -length / 2};
    const RoundedRectangle slot{length - less, width - less, (width - less) / 2};
    return placed(placed(taken(clear_pocket(slot, tool_mm, step), cycle), along[place], 0, 0), 0, 0,
                  cycle_value("Q374", 0));
  }
  const double x[] = {0, length / 2, -length / 2, -length / 2, length / 2};
  const double y[] = {0, width / 2, width / 2, -width / 2, -width / 2};
  const double corner = mm_of("Q220");
  if (corner < 0) throw ProgramFault{"Q220", "below 0, a chamfer, is not supported"};
  const AreaPath path =
      cycle == 251
          ? taken(clear_pocket({length - less, width - less, std::max(0.0, corner - allowance_mm)},
                               tool_mm, step),
                  cycle)
          : taken(mill_stud({length + less, width + less, corner + allowance_mm},
                            {std::max(length + less, mm_of("Q424")),
                             std::max(width + less, mm_of("Q425")), 0},
                            tool_mm, step),
                  cycle);
  return placed(placed(path, x[place], y[place], 0), 0, 0, cycle_value("Q224", 0));
}

void KlartextMachine::mill_area(double raised_mm) {
  const std::string name = "CYCL DEF " + std::to_string(cycle_number_);
  const double tool_mm = tool_radius_mm(name);
  const double set_up = cycle_value("Q200", 0) * unit_mm_;
  const double surface = cycle_value("Q203", 0) * unit_mm_ + raised_mm;
  const double clearance = surface + set_up;
  const double high = std::max(clearance, surface + cycle_value("Q204", 0) * unit_mm_);
  const double bottom = surface + cycle_value("Q201", 0) * unit_mm_;
  if (!(bottom < surface)) throw ProgramFault{"Q201", "must be a depth below 0"};
  const double side_mm = cycle_value("Q368", 0) * unit_mm_;
  const double floor_mm = cycle_value("Q369", 0) * unit_mm_;
  // Studs of older controls have no Q215 and keep their allowance.
  const double kind = cycle_value("Q215", cycle_number_ >= 256 ? 1 : 0);
  if (kind != 0 && kind != 1 && kind != 2) throw ProgramFault{"Q215", "must be 0, 1 or 2"};
  const auto machining = static_cast<Machining>(static_cast<int>(kind));
  const bool rough = machining == Machining::kRoughing;
  const AreaPath whole = area(tool_mm, rough ? side_mm : 0);
  std::vector<std::pair<AreaPath, double>> passes;
  if (machining == Machining::kFinishing) {
    if (floor_mm != 0) passes.emplace_back(whole, bottom);
    if (side_mm != 0) passes.emplace_back(last_loop(whole), bottom);
  } else {
    for (const double level :
         pass_levels(surface, bottom + (rough ? floor_mm : 0), cycle_value("Q202", 0) * unit_mm_))
      passes.emplace_back(whole, level);
  }
  const bool arc_slot = cycle_number_ == 254;
  const int copies = arc_slot && cycle_.contains("Q377") ? count_of(cycle_, "Q377") : 1;
  std::size_t moves = 0;
  for (const auto& pass : passes) moves += pass.first.size();
  if (moves * static_cast<std::size_t>(copies) > kAreaMovesMax)
    throw ProgramFault{name, "takes more than 100000 moves; state a larger infeed Q202"};
  const Vec3 called = path_.position();
  const std::optional<double> feed_before = feed_;
  const double milling = cycle_value("Q207", 0) * unit_mm_;
  if (milling > 0) feed_ = milling;
  const double plunge = cycle_value("Q206", 0) > 0 ? cycle_value("Q206", 0) * unit_mm_ : feed();
  const auto rapid_to = [this](Vec3 to) { move(to, std::nullopt, {true, true, true}); };
  rapid_to({called.x, called.y, clearance});
  for (int copy = 0; copy < copies; ++copy) {
    const double x = arc_slot ? cycle_value("Q216", 0) * unit_mm_ : called.x;
    const double y = arc_slot ? cycle_value("Q217", 0) * unit_mm_ : called.y;
    const double turn = arc_slot ? copy * cycle_value("Q378", 0) : 0;
    double before = surface;
    for (const auto& [path, level] : passes) {
      const AreaPath here = placed(path, x, y, turn);
      rapid_to({here[0].x, here[0].y, clearance});
      rapid_to({here[0].x, here[0].y, std::min(clearance, before + set_up)});
      move({here[0].x, here[0].y, level}, plunge, {false, false, true});
      follow(here);
      rapid_to({path_.position().x, path_.position().y, clearance});
      before = level;
    }
  }
  rapid_to({path_.position().x, path_.position().y, high});
  rapid_to({called.x, called.y, high});
  feed_ = feed_before;
}

// Makes the moves after the first at the tool's depth.
void KlartextMachine::follow(const AreaPath& path) {
  const double z = path_.position().z;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const AreaMove& to = path[i];
    if (to.turns == 0) {
      move({to.x, to.y, z}, feed(), {true, true, false});
    } else {
      move_arc({to.x, to.y, z}, ArcPlane::kXy, {to.center_x, to.center_y, z}, to.turns);
    }
  }
}

// 220: points on a circle; 221: on a grid, back and forth. Both call the active cycle with their
// own clearances and surface.
void KlartextMachine::call_pattern(int cycle, const std::map<std::string, double>& given) {
  const std::string name = "CYCL DEF " + std::to_string(cycle);
  if (cycle_number_ == 0 || cycle_number_ == 1 || cycle_number_ == 254)
    throw ProgramFault{name, "requires a cycle for holes, pockets or studs before it"};
  const auto value = [&given](const char* word) {
    const auto it = given.find(word);
    return it == given.end() ? 0.0 : it->second;
  };
  for (const char* word : {"Q200", "Q203", "Q204"})
    if (given.contains(word)) cycle_[word] = value(word);
  std::vector<PatternHole> holes;
  double x = value("Q225"), y = value("Q226");
  if (cycle == 220) {
    const int count = count_of(given, "Q241");
    const double span = value("Q246") - value("Q245");
    const bool whole = std::abs(std::abs(span) - 360) < 1e-9;
    const double step = value("Q247") != 0    ? value("Q247")
                        : whole || count == 1 ? span / count
                                              : span / (count - 1);
    holes = holes_on_circle(count, value("Q244") / 2, value("Q245"), step);
    x = value("Q216");
    y = value("Q217");
  } else {
    const int columns = count_of(given, "Q242"), rows = count_of(given, "Q243");
    if (columns * double(rows) > kPatternHolesMax)
      throw ProgramFault{name, "has above 10000 points"};
    holes = holes_on_grid(columns, rows, value("Q237"), value("Q238"), value("Q224"));
  }
  refuse_in_corner(name);
  const double level =
      value("Q203") + (value("Q301") != 0 ? std::max(value("Q200"), value("Q204")) : value("Q200"));
  for (const PatternHole& hole : holes) {
    Vec3 at = path_.position();
    at.z = std::max(at.z, level * unit_mm_);
    move(at, std::nullopt, {false, false, true});
    move({(x + hole.x) * unit_mm_, (y + hole.y) * unit_mm_, at.z}, std::nullopt,
         {true, true, false});
    call_cycle();
  }
}

// CYCL CALL POS X Y Z: Z shifts the surface of the cycle.
void KlartextMachine::call_at(const Words& words) {
  std::array<bool, 3> named{};
  for (const KlartextWord& word : words)
    if (word.value.empty() || (word.name != "X" && word.name != "Y" && word.name != "Z"))
      throw ProgramFault{word.name + word.value, "is not a word of CYCL CALL POS"};
  const Vec3 to = target(words, named);
  const double raised = named[2] ? to.z : 0;
  Vec3 at = path_.position();
  at.z = std::max(at.z, (cycle_value("Q203", 0) + cycle_value("Q200", 0)) * unit_mm_ + raised);
  move(at, std::nullopt, {false, false, true});
  move({to.x, to.y, at.z}, std::nullopt, {true, true, false});
  call_cycle(raised);
}

}  // namespace kerf
