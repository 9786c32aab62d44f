// SPDX-License-Identifier: Apache-2.0
// Motions of GcodeMachine: targets, lines, arcs, canned cycles and feeds.
#include <algorithm>
#include <cmath>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/machine.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr std::string_view kCenterLetters = "ijk";
constexpr int kTurnsMax = 1000;

}  // namespace

GcodeMachine::Named GcodeMachine::named_axes(const GcodeBlock& block) {
  Named named{};
  for (std::size_t i = 0; i < named.size(); ++i) named[i] = block.find(kAxisLetters[i]) != nullptr;
  if (block.has_any(kPolarLetters)) named[0] = named[1] = true;
  return named;
}

GcodePlace GcodeMachine::place(const GcodeAxes& programmed) const {
  return {frame_.absolute(programmed), tool_axis_};
}

void GcodeMachine::move(GcodeBlock& block) {
  if (block_motion_ < 0) return;
  const int code = block_motion_;
  if (code != 800 && !block.has_code(GcodeGroup::kNonModal, 530)) refer_systems();
  if (!is_canned_cycle(code)) {
    cycle_.code = 0;
    cycle_.initial_level.reset();
  }
  if (code == 800) {
    modes_.motion = setup_.rules.macros ? path_motion_ : code;
  } else if (is_canned_cycle(code)) {
    cycle(block, code);
  } else if (code <= 10) {
    straight(block, code);
  } else if (code == 50 || code == 51) {
    spline(block, code == 50);
  } else if (code == 331) {
    tap(block);
  } else if (code == 120 || code == 130) {
    circular_pocket(block, code == 120);
  } else if (code == 1500) {
    begin_outline(block);
  } else {
    arc(block, code == 20);
  }
}

GcodeAxes GcodeMachine::read_target(GcodeBlock& block) {
  if (setup_.rules.macros) check_after_transform(block);
  GcodeAxes to = corner_ ? corner_->at : at_;
  if (!corner_ && compensation_.beside()) {
    const Vec3 programmed = from_plane(compensation_.programmed(), compensation_.plane());
    to[0] = programmed.x;
    if (compensation_.plane() == ArcPlane::kXy) to[1] = programmed.y;
    if (compensation_.plane() == ArcPlane::kZx) to[2] = programmed.z;
  }
  if (beside_) return_to_path(block, to);
  for (std::size_t i = 0; i < to.size(); ++i) {
    const auto value = block.take(kAxisLetters[i]);
    if (!value) continue;
    const double written = *value * (i < 3 ? modes_.unit_mm : 1);
    to[i] = modes_.incremental ? to[i] + written : written;
  }
  read_polar(block, to);
  return to;
}

// After G40 the first move within the plane starts at the programmed point. Any other move, such as
// a retraction, keeps the tool offset from it.
void GcodeMachine::return_to_path(const GcodeBlock& block, GcodeAxes& to) {
  const std::string_view letters = plane_letters(compensation_.plane());
  if (!block.has_any(letters.substr(0, 2)) && !block.has_any(kPolarLetters)) return;
  PlanePoint point = in_plane(linear(to), compensation_.plane());
  point.first = beside_->first;
  point.second = beside_->second;
  set_linear(to, from_plane(point, compensation_.plane()));
  beside_.reset();
}

void GcodeMachine::read_polar(GcodeBlock& block, GcodeAxes& to) {
  const auto distance = block.take('@');
  const auto angle = block.take('^');
  if (!distance && !angle) return;
  if (to[0] == 0 && to[1] == 0 && (modes_.incremental || !angle))
    throw ProgramFault{"", "polar coordinates from the origin require both @ and ^ and G90"};
  double radius = std::hypot(to[0], to[1]);
  double turn = std::atan2(to[1], to[0]);
  if (modes_.incremental) {
    radius += distance.value_or(0) * modes_.unit_mm;
    turn += angle.value_or(0) * kRadPerDeg;
  } else {
    if (distance) radius = *distance * modes_.unit_mm;
    if (angle) turn = *angle * kRadPerDeg;
  }
  to[0] = radius * std::cos(turn);
  to[1] = radius * std::sin(turn);
}

// Reads the target of G53, in machine coordinates.
GcodeAxes GcodeMachine::read_machine_target(GcodeBlock& block) {
  if (block.has_any(kPolarLetters)) throw ProgramFault{"G53", "does not take polar coordinates"};
  GcodeAxes target = frame_.absolute(at_);
  for (std::size_t i = 0; i < target.size(); ++i) {
    const auto value = block.take(kAxisLetters[i]);
    if (value) target[i] = *value * (i < 3 ? modes_.unit_mm : 1) - (i < 3 ? tool_offset_[i] : 0);
  }
  GcodeAxes to = frame_.programmed(target);
  // Axes without a word keep their coordinates bit-identical.
  for (std::size_t i = 2; i < to.size(); ++i)
    if (block.find(kAxisLetters[i]) == nullptr) to[i] = at_[i];
  return to;
}

Vec3 GcodeMachine::read_tool_axis(GcodeBlock& block) {
  const auto i = block.take('i');
  const auto j = block.take('j');
  const auto k = block.take('k');
  if (!i && !j && !k) return tool_axis_;
  if (!i || !j || !k) throw ProgramFault{"I J K", "the tool axis requires all three of I, J and K"};
  const Vec3 axis{*i, *j, *k};
  const double size = length(axis);
  if (!(size > 1e-6) || !std::isfinite(size))
    throw ProgramFault{"I J K", "the tool axis must be a finite vector other than 0 0 0"};
  return axis;
}

void GcodeMachine::straight(GcodeBlock& block, int code) {
  arc_rejected_ = false;
  const bool is_rapid = code == 0;
  if (!is_rapid) require_feed(block);
  modes_.motion = code;
  const bool in_machine = block.has_code(GcodeGroup::kNonModal, 530);
  const Named named = named_axes(block);
  if (in_machine) {
    reject_compensated(*block.code(GcodeGroup::kNonModal));
    if (!is_rapid && !setup_.machine_zero_known)
      throw ProgramFault{
          "G53",
          "requires G0 unless a parameter file is given, because the machine zero is "
          "not known"};
  }
  const GcodeAxes to = in_machine ? read_machine_target(block) : read_target(block);
  if (setup_.tool_axis_words) tool_axis_ = read_tool_axis(block);
  if (setup_.rules.macros && !is_rapid) {
    if (corner_) cut_corner(to);
    if (begin_corner(block, to)) return;
  }
  if (compensation_.active()) {
    CompensatedInfo info{.axes = to,
                         .feed = is_rapid ? GcodeFeed{} : feed_of(block),
                         .named = named,
                         .file = file_,
                         .line = line_};
    if (!is_rapid && modes_.feed_mode == GcodeFeedMode::kInverseTime) {
      info.per_move = block.find('f')->value;
      info.feed.duration_s = 0;
    }
    return follow_line(is_rapid, to, info);
  }
  if (is_rapid) {
    rapid(to, in_machine ? GcodeRapid::kMachine : GcodeRapid::kPlain, named);
  } else {
    feed(to, feed_of(block), named);
  }
}

// Moves along the programmed path, offset to the point that belongs to `to`.
void GcodeMachine::follow_line(bool is_rapid, const GcodeAxes& to, const CompensatedInfo& info) {
  const ArcPlane plane = compensation_.plane();
  const PlanePoint end = compensation_.straight(is_rapid, in_plane(linear(at_), plane),
                                                in_plane(linear(to), plane), info);
  at_ = to;
  set_linear(at_, from_plane(end, plane));
}

void GcodeMachine::follow_arc(const GcodeAxes& to, const ArcCenter& center, bool clockwise,
                              int turns, double tolerance_mm, const CompensatedInfo& info) {
  const ArcPlane plane = compensation_.plane();
  const PlanePoint end =
      compensation_.arc(in_plane(linear(at_), plane), in_plane(linear(to), plane), center,
                        clockwise, turns, tolerance_mm, info);
  at_ = to;
  set_linear(at_, from_plane(end, plane));
}

void GcodeMachine::set_position(const GcodeAxes& programmed) {
  at_ = programmed;
  actual_ = frame_.absolute(programmed);
}

void GcodeMachine::rapid(const GcodeAxes& to, GcodeRapid kind, const Named& named) {
  if (reads_outline()) return record_outline(to, std::nullopt, 0);
  count_call();
  canon_.rapid(place(to), kind, named);
  set_position(to);
}

void GcodeMachine::feed(const GcodeAxes& to, const GcodeFeed& feed, const Named& named) {
  if (reads_outline()) return record_outline(to, std::nullopt, 0);
  count_call();
  canon_.feed(place(to), feed, named);
  set_position(to);
}

ArcCenter GcodeMachine::read_center(GcodeBlock& block) const {
  ArcCenter center;
  center.absolute = modes_.arc_absolute;
  const bool macros = setup_.rules.macros;
  if (macros)
    for (const char letter : kCenterLetters)
      if (block.find(letter) != nullptr && block.find('r') != nullptr) block.take(letter);
  if (const auto radius = block.take('r')) {
    if (block.has_any(kCenterLetters) && !macros)
      throw ProgramFault{block.find('r')->text, "excludes I, J and K; give either R or the center"};
    if (*radius == 0) throw ProgramFault{block.find('r')->text, "the radius must not be 0"};
    const std::string_view ends = plane_letters(modes_.plane).substr(0, 2);
    if (!block.has_any(ends) && !block.has_any(kPolarLetters))
      throw ProgramFault{block.find('r')->text,
                         "requires an end coordinate in the plane of the arc"};
    center.radius = *radius * modes_.unit_mm;
    return center;
  }
  const std::string_view letters = modes_.plane == ArcPlane::kXy   ? "ij"
                                   : modes_.plane == ArcPlane::kZx ? "ki"
                                                                   : "jk";
  for (const char letter : kCenterLetters) {
    const GcodeWord* word = block.find(letter);
    if (word == nullptr || letters.find(letter) != std::string_view::npos) continue;
    if (macros && word->value == 0)
      block.take(letter);
    else
      throw ProgramFault{word->text, "is not a center coordinate of the active plane"};
  }
  if (!block.has_any(letters)) throw ProgramFault{"", "an arc requires R or the center as I, J, K"};
  if (modes_.arc_absolute &&
      (block.find(letters[0]) == nullptr || block.find(letters[1]) == nullptr))
    throw ProgramFault{"G90.1", "requires both coordinates of the arc's center"};
  center.ijk = {block.take('i').value_or(0) * modes_.unit_mm,
                block.take('j').value_or(0) * modes_.unit_mm,
                block.take('k').value_or(0) * modes_.unit_mm};
  return center;
}

void GcodeMachine::arc(GcodeBlock& block, bool clockwise) {
  if (arc_rejected_)
    throw ProgramFault{"", "the first move after cutter compensation (G40) must be straight"};
  require_feed(block);
  const ArcCenter center = read_center(block);
  int turns = 1;
  if (const auto p = block.take('p')) {
    if (*p < 1 || *p > kTurnsMax || *p != std::floor(*p))
      throw ProgramFault{block.find('p')->text,
                         "the number of turns must be an integer from 1 to 1000"};
    turns = static_cast<int>(*p);
  }
  const Named named = named_axes(block);
  const GcodeAxes to = read_target(block);
  modes_.motion = clockwise ? 20 : 30;
  const std::string_view ends = plane_letters(modes_.plane);
  const auto scale = [&](char axis) {
    return std::abs(frame_.scale[static_cast<std::size_t>(axis - 'x')]);
  };
  if (scale(ends[0]) != scale(ends[1]))
    throw ProgramFault{"",
                       "an arc with unequal scale factors is no circle, which is not supported"};
  const double tolerance = modes_.unit_mm == 1 ? kSpiralToleranceMm : kSpiralToleranceInchMm;
  if (compensation_.active()) {
    CompensatedInfo info{
        .axes = to, .feed = feed_of(block), .named = named, .file = file_, .line = line_};
    if (modes_.feed_mode == GcodeFeedMode::kInverseTime) {
      info.per_move = block.find('f')->value;
      info.feed.duration_s = 0;
    }
    return follow_arc(to, center, clockwise, turns, tolerance, info);
  }
  const PlanePoint middle =
      arc_center(linear(at_), linear(to), modes_.plane, center, clockwise, tolerance);
  if (reads_outline()) return record_outline(to, middle, clockwise ? -turns : turns);
  count_call();
  canon_.arc(arc_about(linear(at_), linear(to), modes_.plane, middle, clockwise ? -turns : turns),
             frame_, place(to), feed_of(block), named);
  set_position(to);
}

void GcodeMachine::emit(const CompensatedMove& move) {
  count_call();
  const bool earlier = move.info.line != line_ || move.info.file != file_;
  if (earlier) canon_.at_line(move.info.file, move.info.line);
  if (move.kind == CompensatedMove::Kind::kDwell) {
    canon_.dwell(move.seconds);
  } else {
    GcodeAxes to = move.info.axes;
    set_linear(to, from_plane(move.end, compensation_.plane()));
    const GcodePlace target = place(to);
    if (move.kind == CompensatedMove::Kind::kRapid) {
      canon_.rapid(target, GcodeRapid::kPlain, move.info.named);
    } else if (move.kind == CompensatedMove::Kind::kFeed) {
      canon_.feed(target, move.info.feed, move.info.named);
    } else {
      canon_.arc(arc_about(linear(frame_.programmed(actual_)), linear(to), compensation_.plane(),
                           move.center, move.turns),
                 frame_, target, move.info.feed, move.info.named);
    }
    actual_ = target.axes;
  }
  if (earlier) canon_.at_line(file_, line_);
}

void GcodeMachine::go_home(GcodeBlock& block, int code) {
  Named named = named_axes(block);
  const GcodeAxes via = read_target(block);
  rapid(via, GcodeRapid::kPlain, named);
  using namespace gcode_parameter;
  GcodeAxes home = stored_axes(code == 280 ? kHome28 : kHome30);
  for (std::size_t i = 0; i < 3; ++i) home[i] -= tool_offset_[i];
  home = frame_.programmed(home);
  if (named == Named{}) named.fill(true);
  GcodeAxes to = via;
  for (std::size_t i = 0; i < to.size(); ++i)
    if (named[i]) to[i] = home[i];
  rapid(to, GcodeRapid::kMachine, named);
}

}  // namespace kerf
