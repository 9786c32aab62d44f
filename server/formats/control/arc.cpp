// SPDX-License-Identifier: Apache-2.0
#include "server/formats/control/arc.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "server/formats/control/fault.h"
#include "server/formats/number_text.h"

namespace kerf {
namespace {

constexpr double kTurnRad = 2 * std::numbers::pi;
constexpr double kRadiusDifferenceRelative = 0.001;
constexpr double kRadiusDifferenceMaxFactor = 100;
// A radius below this counts as zero, and an R shorter than half the chord by at most this is
// accepted as rounding of the program's text (LinuxCNC: 0.00005 inch).
constexpr double kRadiusToleranceMm = 0.00127;
// Ends nearer than this are equal, which makes a full circle. One step of the pose grid.
constexpr double kWholeTurnMm = 1e-6;
constexpr double kChordMaxRad = std::numbers::pi / 4;

// Returns the center for the R form: on the perpendicular bisector of the chord, on the side that
// makes the sweep at most 180° for R > 0.
PlanePoint center_of_radius(PlanePoint a, PlanePoint b, double radius, bool clockwise) {
  const double dx = b.first - a.first;
  const double dy = b.second - a.second;
  const double chord = std::hypot(dx, dy);
  if (chord < kWholeTurnMm)
    throw ProgramFault{"R", "cannot define a full circle; give the center with I, J, K"};
  const double half = chord / 2;
  if (half > std::abs(radius) + kRadiusToleranceMm)
    throw ProgramFault{"R", "is less than half the distance of " + decimal_text(chord, 6) +
                                " mm between start and end"};
  const double height = std::sqrt(std::max(radius * radius - half * half, 0.0));
  const double side = (radius > 0) == clockwise ? -1.0 : 1.0;
  return {a.first + dx / 2 - side * height * dy / chord,
          a.second + dy / 2 + side * height * dx / chord, 0};
}

void check_radii(double start, double end, double tolerance_mm) {
  if (start < kRadiusToleranceMm)
    throw ProgramFault{"", "the center of the arc is its start; give I, J, K or R"};
  if (end < kRadiusToleranceMm)
    throw ProgramFault{"", "the center of the arc is its end; correct I, J, K or the end"};
  const double difference = std::abs(start - end);
  if (difference > kRadiusDifferenceMaxFactor * tolerance_mm ||
      (difference > tolerance_mm && difference > kRadiusDifferenceRelative * std::max(start, end)))
    throw ProgramFault{"", "the radius of the arc is " + decimal_text(start, 6) +
                               " mm at its start but " + decimal_text(end, 6) + " mm at its end"};
}

}  // namespace

PlanePoint in_plane(Vec3 v, ArcPlane plane) {
  switch (plane) {
    case ArcPlane::kZx:
      return {v.z, v.x, v.y};
    case ArcPlane::kYz:
      return {v.y, v.z, v.x};
    case ArcPlane::kXy:
      break;
  }
  return {v.x, v.y, v.z};
}

Vec3 from_plane(PlanePoint p, ArcPlane plane) {
  switch (plane) {
    case ArcPlane::kZx:
      return {p.second, p.normal, p.first};
    case ArcPlane::kYz:
      return {p.normal, p.first, p.second};
    case ArcPlane::kXy:
      break;
  }
  return {p.first, p.second, p.normal};
}

PlanePoint arc_center(Vec3 start, Vec3 end, ArcPlane plane, const ArcCenter& center, bool clockwise,
                      double spiral_tolerance_mm) {
  const PlanePoint a = in_plane(start, plane);
  const PlanePoint b = in_plane(end, plane);
  if (center.radius) return center_of_radius(a, b, *center.radius, clockwise);
  PlanePoint c = in_plane(center.ijk, plane);
  if (!center.absolute) c = {a.first + c.first, a.second + c.second, 0};
  check_radii(std::hypot(a.first - c.first, a.second - c.second),
              std::hypot(b.first - c.first, b.second - c.second), spiral_tolerance_mm);
  return c;
}

Arc arc_about(Vec3 start, Vec3 end, ArcPlane plane, PlanePoint c, int turns) {
  const PlanePoint a = in_plane(start, plane);
  const PlanePoint b = in_plane(end, plane);
  const bool clockwise = turns < 0;
  Arc arc{.start = start,
          .end = end,
          .plane = plane,
          .center_first = c.first,
          .center_second = c.second,
          .turns = turns};
  arc.start_radius = std::hypot(a.first - c.first, a.second - c.second);
  arc.end_radius = std::hypot(b.first - c.first, b.second - c.second);
  arc.start_angle_rad = std::atan2(a.second - c.second, a.first - c.first);
  const double end_angle = std::atan2(b.second - c.second, b.first - c.first);
  double sweep = std::fmod(end_angle - arc.start_angle_rad, kTurnRad);
  const bool full = std::hypot(a.first - b.first, a.second - b.second) < kWholeTurnMm;
  if (full) sweep = 0;
  if (!clockwise && sweep <= 0) sweep += kTurnRad;
  if (clockwise && sweep >= 0) sweep -= kTurnRad;
  arc.sweep_rad = sweep + kTurnRad * (clockwise ? turns + 1 : turns - 1);
  return arc;
}

Arc make_arc(Vec3 start, Vec3 end, ArcPlane plane, const ArcCenter& center, bool clockwise,
             int turns) {
  return arc_about(start, end, plane, arc_center(start, end, plane, center, clockwise),
                   clockwise ? -turns : turns);
}

Vec3 Arc::at(double s) const {
  if (s <= 0) return start;
  if (s >= 1) return end;
  const double angle = start_angle_rad + sweep_rad * s;
  const double radius = start_radius + (end_radius - start_radius) * s;
  const double from = in_plane(start, plane).normal;
  const double to = in_plane(end, plane).normal;
  return from_plane({center_first + radius * std::cos(angle),
                     center_second + radius * std::sin(angle), from + (to - from) * s},
                    plane);
}

double Arc::length_mm() const {
  const double radius = (start_radius + end_radius) / 2;
  return std::hypot(radius * sweep_rad,
                    in_plane(end, plane).normal - in_plane(start, plane).normal);
}

int Arc::chords(double tolerance_mm) const {
  const double radius = std::max(start_radius, end_radius);
  const double cosine = std::clamp(1 - tolerance_mm / radius, -1.0, 1.0);
  const double step = std::clamp(2 * std::acos(cosine), 1e-5, kChordMaxRad);
  return static_cast<int>(std::clamp(std::ceil(std::abs(sweep_rad) / step), 1.0, 1e9));
}

}  // namespace kerf
