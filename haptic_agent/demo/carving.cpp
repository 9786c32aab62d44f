// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/demo/carving.h"

#include <algorithm>
#include <cmath>

namespace kerf::demo {
namespace {

constexpr double kMapPitchMm = 0.2;
constexpr double kPastMouthRad = 0.14;  // strokes begin before the mouth to expose its face

using Line = std::vector<Vec3>;

// Returns the distance from a point, in a direction, at which the dish fraction equals `fraction`.
double reach_in_dish(const Ammonite& ammonite, Vec3 from, double angle, double fraction) {
  double low = 0, high = 200;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    const bool inside = ammonite.dish_fraction(from.x + middle * std::cos(angle),
                                               from.y + middle * std::sin(angle)) < fraction;
    (inside ? low : high) = middle;
  }
  return low;
}

// Returns one arm of a spiral from the rim of the dish to its center. A second arm, rotated by half
// a turn, runs between its turns.
Line dish_spiral(const Ammonite& ammonite, double begin_angle, double turns, double rim) {
  Line line;
  const int count = static_cast<int>(turns * 180);
  for (int i = 0; i <= count; ++i) {
    const double angle = begin_angle - kTurn * i / 180.0;
    // The first half turn follows the rim, so that the two arms clear all of it.
    const double share = std::clamp((i - 90.0) / (count - 90.0), 0.0, 1.0);
    const double radius = (1 - share) * reach_in_dish(ammonite, {}, angle, rim);
    line.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
  }
  return line;
}

// Returns the distance of the shell's outline from the spiral's center. The step at the mouth is
// spread over kSpreadRad.
double outline(const Ammonite& ammonite, double angle) {
  double along = std::fmod(angle - ammonite.mouth_angle_rad, kTurn);
  if (along <= 0) along += kTurn;  // (0, turn]: 0 is just past the mouth
  const double radius = ammonite.tube_radius(ammonite.mouth_angle_rad - kTurn + along);
  constexpr double kSpreadRad = 0.09;
  if (along > kSpreadRad) return radius;
  const double share = along / kSpreadRad;
  return ammonite.outer_radius_mm * (1 - share) + radius * share;
}

// Returns rings that blend from the rim of the dish into the shell's outline.
Line dish_rings(const Ammonite& ammonite, int rings, double rim) {
  Line line;
  const Vec3 center = ammonite.center_mm;
  for (int i = 0; i <= rings * 240; ++i) {
    const double angle = ammonite.mouth_angle_rad + kTurn * i / 240.0;
    const double share = std::clamp((i - 240.0) / (rings * 240.0 - 480.0), 0.0, 1.0);
    const double outer = reach_in_dish(ammonite, center, angle, rim);
    const double inner = std::min(outer, outline(ammonite, angle) - 1.5);
    const double radius = outer + share * (inner - outer);
    line.push_back(center + Vec3{radius * std::cos(angle), radius * std::sin(angle), 0});
  }
  return line;
}

// Returns strokes across the outer whorl, starting at the mouth, in alternating directions without
// lifting, slanted like the ribs.
Line across_whorl(const Ammonite& ammonite, double turns, double step_mm) {
  Line line;
  bool outwards = false;
  double angle = ammonite.mouth_angle_rad + kPastMouthRad;
  while (angle > ammonite.mouth_angle_rad - turns * kTurn) {
    for (int i = -24; i <= 24; ++i) {
      const double fraction = (outwards ? i : -i) / 24.0 * 1.08;
      const double lean = 0.035 * (1.1 * fraction * fraction + 0.5 * fraction - 0.6);
      const double at = std::min(angle + lean, ammonite.mouth_angle_rad + kPastMouthRad);
      line.push_back(ammonite.across(at, fraction));
    }
    outwards = !outwards;
    angle -= step_mm / (0.8 * ammonite.tube_radius(angle));
  }
  return line;
}

// Returns strokes along the coil, in alternating directions, each offset further across the tube.
Line along_coil(const Ammonite& ammonite, double first_angle, double last_angle, int strokes) {
  Line line;
  for (int k = 0; k < strokes; ++k) {
    const double fraction = -1.05 + 2.1 * k / (strokes - 1.0);
    const int count = static_cast<int>((last_angle - first_angle) / 0.05);
    for (int i = 0; i <= count; ++i) {
      const double share = 1.0 * (k % 2 == 0 ? i : count - i) / count;
      line.push_back(ammonite.across(first_angle + share * (last_angle - first_angle), fraction));
    }
  }
  return line;
}

}  // namespace

Carving carve(const Ammonite& ammonite) {
  const HeightMap target(ammonite.block_min_mm, ammonite.block_max_mm, kMapPitchMm,
                         [&](double x, double y) { return ammonite.height(x, y); });
  Carving carving;
  const Follower coarse(
      target, kCoarse,
      {.allowance_mm = 0.6, .tilt_max_deg = 22, .tilt_share = 0.6, .step_mm = 1, .smooth_mm = 12});
  for (const double level_mm : {ammonite.floor_mm / 2, ammonite.floor_mm}) {
    carving.first.push_back(coarse.along(dish_spiral(ammonite, 0, 4.5, 0.9), 55, level_mm));
    carving.second.push_back(
        coarse.along(dish_spiral(ammonite, kTurn / 2, 4.5, 0.9), 55, level_mm));
  }
  const double one_back = ammonite.mouth_angle_rad - kTurn;
  carving.first.push_back(Follower(target, kShell, {.step_mm = 0.8, .smooth_mm = 5})
                              .along(across_whorl(ammonite, 1.06, 0.5), 55));
  carving.second.push_back(
      Follower(target, kFloor, {.tilt_max_deg = 30, .step_mm = 0.8, .smooth_mm = 8})
          .along(dish_rings(ammonite, 21, 0.985), 60));
  carving.second.push_back(Follower(target, kFine, {.step_mm = 0.5, .smooth_mm = 3})
                               .along(along_coil(ammonite, ammonite.first_angle_rad() + kTurn * 0.3,
                                                 one_back + 0.35, 25),
                                      45));
  for (auto* strokes : {&carving.first, &carving.second}) {
    *strokes = divided(*strokes, kStrokeSeconds);
  }
  return carving;
}

}  // namespace kerf::demo
