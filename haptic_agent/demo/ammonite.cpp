// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/demo/ammonite.h"

#include <algorithm>
#include <cmath>

namespace kerf::demo {
namespace {

constexpr double kDishWallMm = 11;    // from the rim to the floor
constexpr double kOverlap = 1.07;     // each whorl overlaps the previous one
constexpr double kRoundness = 0.95;   // tube height above the floor / half width
constexpr double kRibHeight = 0.075;  // relative to the tube height
constexpr double kMouthRad = 0.11;    // angle over which the tube closes at the mouth

double smoothstep(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace

double Ammonite::first_angle_rad() const { return mouth_angle_rad - turns * kTurn; }

double Ammonite::tube_radius(double angle_rad) const {
  return outer_radius_mm * std::pow(growth_per_turn, (angle_rad - mouth_angle_rad) / kTurn);
}

Vec3 Ammonite::across(double angle_rad, double fraction) const {
  const double outer = tube_radius(angle_rad), inner = outer / growth_per_turn;
  const double radius = (outer + inner) / 2 + fraction * (outer - inner) / 2;
  return center_mm + Vec3{radius * std::cos(angle_rad), radius * std::sin(angle_rad), 0};
}

double Ammonite::dish_fraction(double x_mm, double y_mm) const {
  const double a = block_max_mm.x - frame_mm, b = block_max_mm.y - frame_mm;
  const double u = x_mm / a, v = y_mm / b;
  return std::sqrt(std::sqrt(u * u * u * u + v * v * v * v));
}

double Ammonite::dish(double x_mm, double y_mm) const {
  const double inside = (1 - dish_fraction(x_mm, y_mm)) * (block_max_mm.y - frame_mm);
  const double t = std::clamp(1 - inside / kDishWallMm, 0.0, 1.0);
  return floor_mm * (1 - t * t);
}

// Returns the height of the tube above the floor at a distance from the spiral's center and an
// angle along the coil.
double Ammonite::tube(double radius_mm, double angle_rad) const {
  const double outer = tube_radius(angle_rad), inner = outer / growth_per_turn;
  const double half_mm = (outer - inner) / 2;
  const double c = (radius_mm - (outer + inner) / 2) / (half_mm * kOverlap);
  if (std::abs(c) >= 1) return 0;
  const double section = std::pow(1 - std::pow(std::abs(c), 2.3), 0.6);
  const double before = mouth_angle_rad - angle_rad;
  const double closing = std::clamp(1 - before / kMouthRad, 0.0, 1.0);
  const double mouth = std::sqrt(1 - closing * closing);
  const double lip = 0.07 * std::exp(-std::pow((before - 0.1) / 0.06, 2));
  // Ribs lean forward towards the outer seam and fade towards both.
  const double lean = 1.1 * c * c + 0.5 * c;
  const double rib = std::cos(ribs_per_turn * angle_rad - 2.2 * lean);
  const double fade = smoothstep((1 - std::abs(c)) / 0.45) * smoothstep((before - 0.2) / 0.2);
  return kRoundness * half_mm * section * mouth * (1 + lip + kRibHeight * fade * rib);
}

double Ammonite::height(double x_mm, double y_mm) const {
  const double dx = x_mm - center_mm.x, dy = y_mm - center_mm.y;
  const double radius = std::sqrt(dx * dx + dy * dy);
  double angle = std::atan2(dy, dx);
  while (angle <= mouth_angle_rad - kTurn) angle += kTurn;
  while (angle > mouth_angle_rad) angle -= kTurn;
  double above_floor = 0;
  for (; angle > first_angle_rad(); angle -= kTurn) {
    above_floor = std::max(above_floor, tube(radius, angle));
  }
  return std::max(dish(x_mm, y_mm), floor_mm + above_floor);
}

}  // namespace kerf::demo
