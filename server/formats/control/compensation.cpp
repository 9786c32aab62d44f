// SPDX-License-Identifier: Apache-2.0
#include "server/formats/control/compensation.h"

#include <cmath>
#include <string>
#include <utility>

#include "server/formats/control/compensation_angle.h"
#include "server/formats/number_text.h"

// The classification of corners follows LinuxCNC's interpreter, so that both produce the same path.
// theta is the direction from the programmed point to the tool center, alpha the direction of the
// next move, and beta the angle by which the path turns away from the tool.
namespace kerf {
namespace {

// Greatest difference between the radii at the ends of a compensated arc, in the program's unit.
constexpr double kArcRadii = 0.01;
// Greatest excess of a compensated arc's sweep over the programmed one (LinuxCNC's values, rad).
constexpr double kArcLongerRad = 0.0254;
constexpr double kArcLongerInchRad = 0.001;

}  // namespace

double sweep_rad(PlanePoint from, PlanePoint center, int turns, PlanePoint to) {
  if (turns == 0) return 0;
  double alpha = direction(center, from);
  double beta = direction(center, to);
  if (turns > 0) {
    if (beta <= alpha) beta += kTwoPi;
    return beta - alpha + (turns - 1) * kTwoPi;
  }
  if (alpha <= beta) alpha += kTwoPi;
  return beta - alpha + (turns + 1) * kTwoPi;
}

bool is_compensation_fault(std::string_view reason) {
  for (const std::string_view part :
       {"cutter compensation", "gouging", "the tool on its inside", "on the side of the tool"})
    if (reason.find(part) != std::string_view::npos) return true;
  return false;
}

double CutterCompensation::quarter() const { return side_ > 0 ? kHalfPi : -kHalfPi; }

void CutterCompensation::start(int side, double radius_mm, ArcPlane plane) {
  side_ = radius_mm < 0 ? -side : side;
  radius_ = std::abs(radius_mm);
  plane_ = plane;
  beside_ = entering_ = false;
}

void CutterCompensation::start_beside(int side, double radius_mm, ArcPlane plane,
                                      PlanePoint contour) {
  start(side, radius_mm, plane);
  beside_ = active();
  programmed_ = contour;
}

std::optional<PlanePoint> CutterCompensation::end(PlanePoint at) {
  std::optional<PlanePoint> programmed;
  if (active() && beside_) {
    flush(at);
    programmed = programmed_;
  }
  side_ = 0;
  beside_ = entering_ = false;
  return programmed;
}

void CutterCompensation::push(const CompensatedMove& move) { waiting_.push_back(move); }

void CutterCompensation::flush(PlanePoint at) {
  shorten_to(at);
  waiting_from_.reset();
}

void CutterCompensation::emit_waiting() {
  const std::vector<CompensatedMove> moves = std::exchange(waiting_, {});
  waiting_from_.reset();
  for (const CompensatedMove& move : moves) emit_(move);
}

// Moves the end of the delayed moves to the corner point and emits them.
void CutterCompensation::shorten_to(PlanePoint point) {
  if (waiting_.empty()) return;
  for (CompensatedMove& move : waiting_) {
    if (move.kind == CompensatedMove::Kind::kDwell) continue;
    check_shortened(move, point);
    move.end.first = point.first;
    move.end.second = point.second;
  }
  emit_waiting();
  waiting_from_ = point;
}

void CutterCompensation::check_shortened(const CompensatedMove& move, PlanePoint point) const {
  if (move.kind != CompensatedMove::Kind::kArc) {
    if (!waiting_from_) return;
    const double along = move.direction_first * (point.first - waiting_from_->first) +
                         move.direction_second * (point.second - waiting_from_->second);
    if (along < 0) reject_gouging("the end of a straight move in an inside corner");
    return;
  }
  const double before = distance(move.center, move.end);
  if (std::abs(before - distance(move.center, point)) > kArcRadii * unit_mm_)
    reject_gouging("the end of an arc in an inside corner");
  if (move.programmed_sweep_rad == 0 || !waiting_from_) return;
  const double sweep = sweep_rad(*waiting_from_, move.center, move.turns, point);
  const double longer = unit_mm_ == 1 ? kArcLongerRad : kArcLongerInchRad;
  if (std::abs(sweep) > std::abs(move.programmed_sweep_rad) + longer)
    reject_gouging("the end of an arc in an inside corner");
}

void CutterCompensation::dwell(double seconds, const CompensatedInfo& info) {
  CompensatedMove move{
      .kind = CompensatedMove::Kind::kDwell, .end = {}, .center = {}, .info = info};
  move.seconds = seconds;
  if (waiting_.empty()) {
    emit_(move);
  } else {
    push(move);
  }
}

PlanePoint CutterCompensation::straight(bool rapid, PlanePoint at, PlanePoint to,
                                        CompensatedInfo info) {
  const PlanePoint from = beside_ ? programmed_ : at;
  if (info.per_move > 0)
    info.feed.mm_per_min = info.per_move * std::hypot(distance(from, to), to.normal - from.normal);
  PlanePoint end;
  const bool across_plane = to.first == at.first && to.second == at.second;
  if (!beside_ && across_plane && entry_ == CompensationEntry::kAcrossNext) {
    emit_({.kind = rapid ? CompensatedMove::Kind::kRapid : CompensatedMove::Kind::kFeed,
           .end = to,
           .center = {},
           .info = info});
    return to;
  }
  if (!beside_) {
    end = enter_straight(rapid, at, to, info);
  } else if (to.first == programmed_.first && to.second == programmed_.second) {
    end = {at.first, at.second, to.normal};
    CompensatedMove move{
        .kind = rapid ? CompensatedMove::Kind::kRapid : CompensatedMove::Kind::kFeed,
        .end = end,
        .center = {},
        .info = info};
    push(move);
  } else {
    end = follow_straight(rapid, at, to, info);
  }
  beside_ = true;
  programmed_ = to;
  return end;
}

PlanePoint CutterCompensation::enter_straight(bool rapid, PlanePoint at, PlanePoint to,
                                              const CompensatedInfo& info) {
  entering_ = entry_ == CompensationEntry::kAcrossNext;
  if (!entering_ && distance(at, to) <= radius_)
    throw ProgramFault{
        "", "the entry move of cutter compensation must be longer than the tool's radius, " +
                decimal_text(radius_, 6) + " mm"};
  const double across = direction(at, to) + quarter();
  waiting_from_ = at;
  CompensatedMove move{.kind = rapid ? CompensatedMove::Kind::kRapid : CompensatedMove::Kind::kFeed,
                       .end = offset_point(to, radius_, across),
                       .center = {},
                       .info = info};
  move.direction_first = std::cos(across);
  move.direction_second = std::sin(across);
  const PlanePoint end = move.end;
  push(move);
  return end;
}

void CutterCompensation::enter_beside(PlanePoint start) {
  for (CompensatedMove& move : waiting_) {
    move.end.first = start.first;
    move.end.second = start.second;
  }
  emit_waiting();
  waiting_from_ = start;
  entering_ = false;
}

PlanePoint CutterCompensation::follow_straight(bool rapid, PlanePoint at, PlanePoint to,
                                               const CompensatedInfo& info) {
  if (entering_) {
    at = offset_point(programmed_, radius_, direction(programmed_, to) + quarter());
    enter_beside(at);
  }
  double theta = direction(programmed_, at);
  double alpha = direction(programmed_, to);
  double beta = 0;
  if (side_ > 0) {
    if (theta < alpha) theta += kTwoPi;
    beta = theta - alpha - kHalfPi;
  } else {
    if (alpha < theta) alpha += kTwoPi;
    beta = alpha - theta - kHalfPi;
  }
  const PlanePoint end = offset_point(to, radius_, alpha + quarter());
  const PlanePoint round_end = offset_point(programmed_, radius_, alpha + quarter());
  const bool turns_back_on_arc =
      beta > kPi - kCornerMinRad && waiting_arc() && !inside(waiting_.front().turns);
  const bool is_inside = beta < -kCornerMinRad || beta > kPi + kCornerMinRad || turns_back_on_arc;
  if (is_inside) {
    shorten_to(waiting_arc() ? inside_corner_after_arc(waiting_.front(), to)
                             : inside_corner(at, theta, beta));
  } else if (beta > kCornerMinRad) {
    shorten_to(at);
    round_corner(rapid, at, round_end, info);
  } else {
    emit_waiting();
    waiting_from_ = at;
  }
  CompensatedMove move{.kind = rapid ? CompensatedMove::Kind::kRapid : CompensatedMove::Kind::kFeed,
                       .end = {end.first, end.second, to.normal},
                       .center = {},
                       .info = info};
  move.direction_first = to.first - programmed_.first;
  move.direction_second = to.second - programmed_.second;
  push(move);
  return {end.first, end.second, to.normal};
}

// Rounds an outside corner with an arc about the programmed point, or straight in a rapid.
void CutterCompensation::round_corner(bool rapid, PlanePoint at, PlanePoint to,
                                      const CompensatedInfo& info) {
  emit_waiting();
  CompensatedMove move{.kind = rapid ? CompensatedMove::Kind::kRapid : CompensatedMove::Kind::kArc,
                       .end = {to.first, to.second, at.normal},
                       .center = {programmed_.first, programmed_.second, 0},
                       .turns = side_ > 0 ? -1 : 1,
                       .info = info};
  emit_(move);
  waiting_from_ = to;
}

PlanePoint CutterCompensation::inside_corner(PlanePoint at, double theta, double beta) const {
  const double half = (beta + kPi) / 2;
  if (half == 0) throw ProgramFault{"", "the path reverses its direction on the side of the tool"};
  return offset_point(at, radius_ / std::tan(half), theta + quarter());
}

PlanePoint CutterCompensation::inside_corner_after_arc(const CompensatedMove& arc,
                                                       PlanePoint to) const {
  const double radius = distance(arc.center, arc.end);
  const double along = direction(programmed_, to);
  const double theta = arc.turns > 0 ? along + kHalfPi : along - kHalfPi;
  const double phi = direction(programmed_, arc.center);
  const bool is_inside = inside(arc.turns);
  const double programmed_radius = is_inside ? radius + radius_ : radius - radius_;
  const double height =
      programmed_radius * std::cos(theta - phi) + (is_inside ? -radius_ : radius_);
  const double cosine = height / radius;
  if (!within_one(cosine)) reject_gouging("the corner of an arc and a straight move");
  const double turn = (arc.turns > 0) == is_inside ? -std::acos(cosine) : std::acos(cosine);
  return offset_point(arc.center, radius, turn + theta + kPi);
}

PlanePoint CutterCompensation::arc(PlanePoint at, PlanePoint to, const ArcCenter& given,
                                   bool clockwise, int turns, double spiral_tolerance_mm,
                                   CompensatedInfo info) {
  const PlanePoint from = beside_ ? programmed_ : at;
  const PlanePoint center = arc_center(from_plane(from, plane_), from_plane(to, plane_), plane_,
                                       given, clockwise, spiral_tolerance_mm);
  const int signed_turns = clockwise ? -turns : turns;
  if (info.per_move > 0)
    info.feed.mm_per_min = info.per_move * std::hypot(distance(center, from) *
                                                          sweep_rad(from, center, signed_turns, to),
                                                      to.normal - from.normal);
  const double programmed_radius = given.radius ? std::abs(*given.radius)
                                   : beside_    ? distance(center, to)
                                                : distance(center, from);
  if (inside(signed_turns) && programmed_radius <= radius_)
    throw ProgramFault{"",
                       "the radius of an arc with the tool on its inside must be greater than "
                       "the tool's, " +
                           decimal_text(radius_, 6) + " mm"};
  const PlanePoint end =
      beside_ ? follow_arc(at, to, center, signed_turns, info)
              : enter_arc(at, to, center, clockwise, turns, spiral_tolerance_mm, info);
  beside_ = true;
  programmed_ = to;
  return end;
}

}  // namespace kerf
