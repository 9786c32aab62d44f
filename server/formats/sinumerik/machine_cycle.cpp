// SPDX-License-Identifier: Apache-2.0
// Drilling cycles of SinumerikMachine: holes to their depth.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "server/formats/control/fault.h"
#include "server/formats/control/hole_pattern.h"
#include "server/formats/sinumerik/machine.h"

namespace kerf {
namespace {

/// Indices of arguments, from 0, or -1 for a missing one. All begin with RTP, RFP, SDIS, DP, DPR.
struct HoleCycle {
  std::string_view name;
  int dwell, feed;
};
constexpr HoleCycle kHoleCycles[] = {{"CYCLE81", -1, -1}, {"CYCLE82", 5, -1},  {"CYCLE83", 8, -1},
                                     {"CYCLE84", 5, -1},  {"CYCLE840", 5, -1}, {"CYCLE85", 5, 6},
                                     {"CYCLE86", 5, -1},  {"CYCLE87", -1, -1}, {"CYCLE88", 5, -1},
                                     {"CYCLE89", 5, -1}};
/// Feed of a tap without a known speed, mm per minute.
constexpr double kTapFeed = 1000;

}  // namespace

// CYCLE81(…), MCALL CYCLE81(…), MCALL.
bool SinumerikMachine::cycle_statement(const std::string& text) {
  const bool modal = text.starts_with("MCALL");
  const std::size_t from = modal ? skip_blanks(text, 5) : 0;
  if (modal && from >= text.size()) return modal_hole_.reset(), true;
  const std::string_view call = std::string_view(text).substr(from);
  const std::size_t open = call.find('(');
  const std::string_view name = call.substr(0, std::min(open, call.find(' ')));
  const bool whole = open != std::string_view::npos && call.ends_with(')');
  const auto arguments = [&] {
    return sinumerik_arguments(call.substr(open + 1, call.size() - open - 2), values_);
  };
  if (name == "CYCLE800" && whole) return swivel(arguments()), true;
  if (whole && !modal && (name == "HOLES1" || name == "HOLES2" || name == "CYCLE801"))
    return drill_pattern(name, arguments()), true;
  const bool is_area = name.starts_with("POCKET") || name.starts_with("CYCLE7");
  if (whole && !modal && is_area && area_statement(name, arguments())) return true;
  const auto* rule = std::ranges::find(kHoleCycles, name, &HoleCycle::name);
  if (rule == std::end(kHoleCycles) || open == std::string_view::npos) {
    if (modal) throw ProgramFault{"MCALL", "is supported with CYCLE81 to CYCLE89 only"};
    return false;
  }
  if (!whole) throw ProgramFault{std::string(name), "lacks ')'"};
  const auto given = arguments();
  const auto value = [&given](int place) {
    const auto at = static_cast<std::size_t>(place);
    return place >= 0 && at < given.size() ? given[at] : std::nullopt;
  };
  Hole hole;
  const double surface = value(1).value_or(0);
  hole.retract = value(0).value_or(0) * unit_mm_;
  hole.above = (surface + std::abs(value(2).value_or(0))) * unit_mm_;
  if (!value(3) && !value(4))
    throw ProgramFault{std::string(name), "requires DP or DPR, the depth"};
  // DP counts if both are given.
  hole.bottom = (value(3) ? *value(3) : surface - std::abs(*value(4))) * unit_mm_;
  hole.seconds = std::max(0.0, value(rule->dwell).value_or(0));
  if (value(rule->feed)) hole.feed = *value(rule->feed) * feed_unit_mm_;
  if (rule->name.starts_with("CYCLE84") && !(feed_ > 0)) hole.feed = kTapFeed;
  if (hole.bottom > hole.above)
    throw ProgramFault{std::string(name), "has a depth above its reference plane"};
  if (modal) return modal_hole_ = hole, true;
  hole_ = hole;
  drill();
  return true;
}

// The active cycle (MCALL) drills at each point of a row (HOLES1), a circle (HOLES2) or a grid
// (CYCLE801).
void SinumerikMachine::drill_pattern(std::string_view name,
                                     const std::vector<std::optional<double>>& given) {
  if (!modal_hole_) throw ProgramFault{std::string(name), "requires MCALL with a drilling cycle"};
  if (plane_ != ArcPlane::kXy)
    throw ProgramFault{std::string(name), "is supported in the plane XY (G17) only"};
  const auto value = [&given](std::size_t at) {
    return at < given.size() ? given[at].value_or(0) : 0.0;
  };
  const auto count = [&](std::size_t at) {
    const double n = value(at);
    if (!(n >= 1 && n <= kPatternHolesMax && n == std::floor(n)))
      throw ProgramFault{std::string(name), "requires the number of holes, from 1 to 10000"};
    return static_cast<int>(n);
  };
  std::vector<PatternHole> holes;
  const int columns = count(5);
  if (name == "HOLES1") {
    holes = holes_on_line(columns, value(4), value(3), value(2));
  } else if (name == "HOLES2") {
    const double step = value(4) != 0 ? value(4) : 360.0 / columns;
    holes = holes_on_circle(columns, value(2), value(3), step);
  } else {
    holes = holes_on_grid(columns, count(6), value(3), value(4), value(2));
  }
  refuse_compensated(std::string(name));
  for (const PatternHole& hole : holes) {
    GcodeAxes to = programmed();
    to[0] = (value(0) + hole.x) * unit_mm_;
    to[1] = (value(1) + hole.y) * unit_mm_;
    go_straight(to, {true, true, false, false, false, false}, true, {});
    hole_ = modal_hole_;
    drill();
  }
}

// At the current position along the axis of the plane.
void SinumerikMachine::drill() {
  refuse_compensated("CYCLE");
  require_no_swivel();
  const std::size_t axis = plane_ == ArcPlane::kXy ? 2 : plane_ == ArcPlane::kZx ? 1 : 0;
  GcodeAxes to = frame_.programmed(at_);
  Named named{};
  named[axis] = true;
  const auto go = [&](double level, bool rapid, const GcodeFeed& speed) {
    to[axis] = level;
    const GcodePlace end = place(to);
    if (rapid) {
      canon_.rapid(end, GcodeRapid::kPlain, named);
    } else {
      canon_.feed(end, speed, named);
    }
    at_ = end.axes;
  };
  const GcodeFeed speed =
      hole_->feed ? GcodeFeed{.mm_per_min = *hole_->feed, .deg_per_min = *hole_->feed} : feed();
  if (!(speed.mm_per_min > 0))
    throw ProgramFault{"CYCLE", "requires a feed in mm per minute (G94)"};
  go(hole_->above, true, {});
  go(hole_->bottom, false, speed);
  if (hole_->seconds > 0) canon_.dwell(hole_->seconds);
  go(hole_->retract, true, {});
}

}  // namespace kerf
