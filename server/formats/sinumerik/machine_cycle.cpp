// SPDX-License-Identifier: Apache-2.0
// Drilling cycles of SinumerikMachine: holes to their depth.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "server/formats/control/fault.h"
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
constexpr double kHolesMax = 10'000;

}  // namespace

// CYCLE81(…), MCALL CYCLE81(…), MCALL.
bool SinumerikMachine::cycle_statement(const std::string& text) {
  const bool modal = text.starts_with("MCALL");
  const std::size_t from = modal ? skip_blanks(text, 5) : 0;
  if (modal && from >= text.size()) return modal_hole_.reset(), true;
  const std::string_view call = std::string_view(text).substr(from);
  const std::size_t open = call.find('(');
  const std::string_view name = call.substr(0, std::min(open, call.find(' ')));
  if (name == "CYCLE800" && open != std::string_view::npos && call.ends_with(')')) {
    swivel(sinumerik_arguments(call.substr(open + 1, call.size() - open - 2), values_));
    return true;
  }
  if (open != std::string_view::npos && call.ends_with(')') && !modal &&
      (name == "HOLES1" || name == "HOLES2" || name == "CYCLE801")) {
    drill_pattern(name,
                  sinumerik_arguments(call.substr(open + 1, call.size() - open - 2), values_));
    return true;
  }
  if (open != std::string_view::npos && call.ends_with(')') && !modal &&
      (name.starts_with("POCKET") || name.starts_with("CYCLE7")) &&
      area_statement(name,
                     sinumerik_arguments(call.substr(open + 1, call.size() - open - 2), values_)))
    return true;
  const auto* rule = std::ranges::find(kHoleCycles, name, &HoleCycle::name);
  if (rule == std::end(kHoleCycles) || open == std::string_view::npos) {
    if (modal) throw ProgramFault{"MCALL", "is supported with CYCLE81 to CYCLE89 only"};
    return false;
  }
  if (!call.ends_with(')')) throw ProgramFault{std::string(name), "lacks ')'"};
  const auto given = sinumerik_arguments(call.substr(open + 1, call.size() - open - 2), values_);
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
    if (!(n >= 1 && n <= kHolesMax && n == std::floor(n)))
      throw ProgramFault{std::string(name), "requires the number of holes, from 1 to 10000"};
    return static_cast<int>(n);
  };
  const auto turned = [](double x, double y, double deg) {
    turn_xy(x, y, deg);
    return std::pair{x, y};
  };
  std::vector<std::pair<double, double>> points;  // from the reference point
  if (name == "HOLES1") {
    for (int i = 0, n = count(5); i < n; ++i)
      points.push_back(turned(value(4) + i * value(3), 0, value(2)));
  } else if (name == "HOLES2") {
    const int n = count(5);
    const double step = value(4) != 0 ? value(4) : 360.0 / n;
    for (int i = 0; i < n; ++i) points.push_back(turned(value(2), 0, value(3) + i * step));
  } else {
    const int columns = count(5), rows = count(6);
    for (int row = 0; row < rows; ++row)
      for (int i = 0; i < columns; ++i) {
        const int column = row % 2 == 0 ? i : columns - 1 - i;
        points.push_back(turned(column * value(3), row * value(4), value(2)));
      }
  }
  refuse_compensated(std::string(name));
  for (const auto& [x, y] : points) {
    GcodeAxes to = programmed();
    to[0] = (value(0) + x) * unit_mm_;
    to[1] = (value(1) + y) * unit_mm_;
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
