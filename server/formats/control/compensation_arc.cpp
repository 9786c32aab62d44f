// SPDX-License-Identifier: Apache-2.0
// Arcs of CutterCompensation, computed as in LinuxCNC's interpreter. compensation.cpp defines the
// angles.
#include <cmath>
#include <string>

#include "server/formats/control/compensation.h"
#include "server/formats/control/compensation_angle.h"
#include "server/formats/number_text.h"

namespace kerf {
namespace {

// Least cosine of the angle between chord and center line for an entry arc to have a center.
constexpr double kEntryCosineMin = 1e-4;
constexpr const char* kNoEntryArc =
    "no entry arc of cutter compensation leads from this start to this end; start from another "
    "point";

}  // namespace

// Entry move along an arc from the tool center to the offset point at the programmed end. Its
// center is on the line through the programmed center and end.
PlanePoint CutterCompensation::enter_arc(PlanePoint at, PlanePoint to, PlanePoint center,
                                         bool clockwise, int turns, double spiral_tolerance_mm,
                                         const CompensatedInfo& info) {
  if (distance(at, to) <= radius_)
    throw ProgramFault{
        "", "the entry arc of cutter compensation must be longer than the tool's radius, " +
                decimal_text(radius_, 6) + " mm"};
  const int signed_turns = clockwise ? -turns : turns;
  const double gamma = inside(signed_turns) ? direction(to, center) : direction(center, to);
  const PlanePoint end = offset_point(to, radius_, gamma);
  const double half_chord = distance(end, at) / 2;
  const double to_center = direction(end, center);
  const double cosine = std::cos(direction(end, at) - to_center);
  if (std::abs(cosine) < kEntryCosineMin) throw ProgramFault{"", kNoEntryArc};
  const PlanePoint moved = offset_point(end, half_chord / cosine, to_center);
  if (std::abs(distance(moved, end) - distance(moved, at)) > spiral_tolerance_mm)
    throw ProgramFault{"", kNoEntryArc};
  CompensatedMove move{.kind = CompensatedMove::Kind::kArc,
                       .end = {end.first, end.second, to.normal},
                       .center = moved,
                       .turns = signed_turns,
                       .info = info};
  move.programmed_sweep_rad = sweep_rad(at, moved, signed_turns, end);
  const PlanePoint result = move.end;
  push(move);
  return result;
}

PlanePoint CutterCompensation::follow_arc(PlanePoint at, PlanePoint to, PlanePoint center,
                                          int turns, const CompensatedInfo& info) {
  const double radius = distance(center, to);
  double delta = direction(programmed_, center);
  if (entering_) {
    at = offset_point(programmed_, radius_, inside(turns) ? delta : delta + kPi);
    enter_beside(at);
  }
  const double theta = direction(programmed_, at) - quarter();
  const double alpha = turns > 0 ? delta - kHalfPi : delta + kHalfPi;
  double beta = side_ > 0 ? theta - alpha : alpha - theta;
  if (beta > 1.5 * kPi) {
    beta -= kTwoPi;
  } else if (beta < -kHalfPi) {
    beta += kTwoPi;
  }
  double gamma = direction(to, center);
  if (!inside(turns)) {
    gamma = direction(center, to);
    delta += kPi;
  }
  const PlanePoint end = offset_point(to, radius_, gamma);
  if (beta < -kCornerMinRad || beta > kPi + kCornerMinRad ||
      (std::abs(beta - kPi) < kCornerMinRad && !inside(turns))) {
    shorten_to(waiting_arc() ? inside_corner_of_arcs(waiting_.front(), center, radius, turns)
                             : inside_corner_before_arc(center, radius, theta, beta, turns));
  } else if (beta > kCornerMinRad) {
    round_corner(false, at, offset_point(programmed_, radius_, delta), info);
  } else {
    emit_waiting();
    waiting_from_ = at;
  }
  CompensatedMove move{.kind = CompensatedMove::Kind::kArc,
                       .end = {end.first, end.second, to.normal},
                       .center = center,
                       .turns = turns,
                       .info = info};
  move.programmed_sweep_rad = sweep_rad(programmed_, center, turns, to);
  const PlanePoint result = move.end;
  push(move);
  return result;
}

PlanePoint CutterCompensation::inside_corner_before_arc(PlanePoint center, double radius,
                                                        double theta, double beta,
                                                        int turns) const {
  const double center_height = radius * std::sin(beta - kHalfPi);
  const bool is_inside = inside(turns);
  const double center_distance = is_inside ? radius - radius_ : radius + radius_;
  const double sine = (center_height + (is_inside ? radius_ : -radius_)) / center_distance;
  if (!within_one(sine)) reject_gouging("the corner before an arc");
  const double turn = std::asin(sine);
  if (is_inside)
    return offset_point(center, center_distance, turns > 0 ? theta + turn : theta - turn);
  return offset_point(center, center_distance, turns > 0 ? theta + kPi - turn : theta + kPi + turn);
}

PlanePoint CutterCompensation::inside_corner_of_arcs(const CompensatedMove& before,
                                                     PlanePoint center, double radius,
                                                     int turns) const {
  const double radius_before = distance(before.center, before.end);
  const double radius_after = inside(turns) ? radius - radius_ : radius + radius_;
  const double apart = distance(before.center, center);
  if (radius_before == 0 || apart == 0)
    throw ProgramFault{"", "two consecutive arcs about the same center cannot be compensated"};
  const double cosine =
      (radius_before * radius_before + apart * apart - radius_after * radius_after) /
      (2 * radius_before * apart);
  if (!within_one(cosine)) reject_gouging("the corner of two arcs");
  const double pull = (turns > 0) == inside(before.turns) ? std::acos(cosine) : -std::acos(cosine);
  return offset_point(before.center, radius_before, direction(before.center, center) + pull);
}

}  // namespace kerf
