#include "server/formats/gcode/arc.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "server/formats/gcode/fault.h"

namespace kerf {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
// LinuxCNC's limits on the difference of the radii at start and end.
constexpr double kRadiusDifferenceMaxMm = 0.5;
constexpr double kRadiusDifferenceMm = 0.005;
constexpr double kRadiusDifferenceRelative = 0.001;
// A radius this much shorter than half the chord is rounding of the program text.
constexpr double kRadiusShortMm = 0.005;
// Points nearer than this are one: a full circle, a centre at the start. One step of the pose grid.
constexpr double kSamePointMm = 1e-6;
constexpr double kChordMaxRad = std::numbers::pi / 4;

struct PlanePoint {
  double first, second, normal;
};

PlanePoint split(Vec3 v, ArcPlane plane) {
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

Vec3 join(PlanePoint p, ArcPlane plane) {
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

// Centre for the R form: on the perpendicular of the chord, on the side that makes the arc short
// for R > 0.
PlanePoint center_of_radius(PlanePoint a, PlanePoint b, double radius, bool clockwise) {
  const double dx = b.first - a.first;
  const double dy = b.second - a.second;
  const double chord = std::hypot(dx, dy);
  if (chord < kSamePointMm)
    throw GcodeFault{"R", "a full circle cannot be given by its radius; use I, J, K"};
  const double half = chord / 2;
  if (half > std::abs(radius) + kRadiusShortMm)
    throw GcodeFault{"R", "is too short: the end is " + std::to_string(chord) + " mm away"};
  const double height = std::sqrt(std::max(radius * radius - half * half, 0.0));
  const double side = (radius > 0) == clockwise ? -1.0 : 1.0;
  return {a.first + dx / 2 - side * height * dy / chord,
          a.second + dy / 2 + side * height * dx / chord, 0};
}

void check_radii(double start, double end) {
  if (start < kSamePointMm) throw GcodeFault{"", "the centre of the arc is its start"};
  const double difference = std::abs(start - end);
  if (difference > kRadiusDifferenceMaxMm ||
      (difference > kRadiusDifferenceMm && difference > kRadiusDifferenceRelative * start))
    throw GcodeFault{"", "the radius of the arc is " + std::to_string(start) +
                             " mm at its start and " + std::to_string(end) + " mm at its end"};
}

}  // namespace

Arc make_arc(Vec3 start, Vec3 end, ArcPlane plane, const ArcCenter& center, bool clockwise,
             int turns) {
  const PlanePoint a = split(start, plane);
  const PlanePoint b = split(end, plane);
  PlanePoint c = split(center.ijk, plane);
  if (center.radius) {
    c = center_of_radius(a, b, *center.radius, clockwise);
  } else if (!center.absolute) {
    c = {a.first + c.first, a.second + c.second, 0};
  }
  Arc arc{.start = start,
          .end = end,
          .plane = plane,
          .center_first = c.first,
          .center_second = c.second};
  arc.start_radius = std::hypot(a.first - c.first, a.second - c.second);
  arc.end_radius = std::hypot(b.first - c.first, b.second - c.second);
  check_radii(arc.start_radius, arc.end_radius);
  arc.start_angle_rad = std::atan2(a.second - c.second, a.first - c.first);
  const double end_angle = std::atan2(b.second - c.second, b.first - c.first);
  double sweep = std::fmod(end_angle - arc.start_angle_rad, kTwoPi);
  const bool full = std::hypot(a.first - b.first, a.second - b.second) < kSamePointMm;
  if (full) sweep = 0;
  if (!clockwise && sweep <= 0) sweep += kTwoPi;
  if (clockwise && sweep >= 0) sweep -= kTwoPi;
  arc.sweep_rad = sweep + (clockwise ? -1 : 1) * kTwoPi * (turns - 1);
  return arc;
}

Vec3 Arc::at(double s) const {
  if (s <= 0) return start;
  if (s >= 1) return end;
  const double angle = start_angle_rad + sweep_rad * s;
  const double radius = start_radius + (end_radius - start_radius) * s;
  const double from = split(start, plane).normal;
  const double to = split(end, plane).normal;
  return join({center_first + radius * std::cos(angle), center_second + radius * std::sin(angle),
               from + (to - from) * s},
              plane);
}

double Arc::length_mm() const {
  const double radius = (start_radius + end_radius) / 2;
  return std::hypot(radius * sweep_rad, split(end, plane).normal - split(start, plane).normal);
}

int Arc::chords(double tolerance_mm) const {
  const double radius = std::max(start_radius, end_radius);
  const double cosine = std::clamp(1 - tolerance_mm / radius, -1.0, 1.0);
  const double step = std::clamp(2 * std::acos(cosine), 1e-5, kChordMaxRad);
  return static_cast<int>(std::clamp(std::ceil(std::abs(sweep_rad) / step), 1.0, 1e9));
}

}  // namespace kerf
