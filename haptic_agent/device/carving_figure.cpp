// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/carving_figure.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf::agent {
namespace {

constexpr int kLaps = 6;
constexpr int kPetals = 5;
constexpr int kPointsPerLap = 720;
/// Rotation between successive laps and variants. An irrational fraction of a turn, so that none
/// coincide.
const double kGoldenAngleRad = std::numbers::pi * (3.0 - std::sqrt(5.0));
constexpr double kReach = 0.4;
constexpr double kDepthShare = 0.04;
constexpr double kDeepestMm = 3.0;
constexpr double kLeanRad = 0.35;
constexpr double kSlowestMmPerS = 5.0;
constexpr double kFastestMmPerS = 60.0;

struct Figure {
  Vec3 middle_mm;  // center of the top
  double reach_mm = 0;
  double depth_mm = 0;
};

TimedPose point_of(const Figure& figure, double lap, double part, double start_rad) {
  const double around = 2.0 * std::numbers::pi * part;
  const double petal = 0.5 + 0.5 * std::cos(kPetals * around);
  const double radius = figure.reach_mm * (0.25 + 0.75 * petal);
  const double angle = start_rad + kGoldenAngleRad * lap + around;
  const double lean = kLeanRad * petal;
  const Vec3 out{std::cos(angle), std::sin(angle), 0};
  const double deep = figure.depth_mm * (1.0 + lap / kLaps) * (0.6 + 0.4 * (1.0 - petal));
  return {.tip_mm = figure.middle_mm + out * radius + Vec3{0, 0, -deep},
          .axis = normalized(out * std::sin(lean) + Vec3{0, 0, std::cos(lean)})};
}

}  // namespace

PoseScript make_carving_figure(const StockBox& stock, std::uint32_t variant) {
  const Vec3 size = stock.max_mm - stock.min_mm;
  const double side_mm = std::min(size.x, size.y);
  const Figure figure{.middle_mm = {(stock.min_mm.x + stock.max_mm.x) / 2,
                                    (stock.min_mm.y + stock.max_mm.y) / 2, stock.max_mm.z},
                      .reach_mm = kReach * side_mm,
                      .depth_mm = std::min({kDepthShare * side_mm, size.z / 8, kDeepestMm})};
  const double speed = std::clamp(side_mm * 0.5, kSlowestMmPerS, kFastestMmPerS);
  const double start_rad = kGoldenAngleRad / kLaps * variant;
  const double clear_mm = std::max(0.1 * side_mm, 2.0);

  PoseScript script;
  const auto go = [&](TimedPose pose, bool cutting) {
    pose.cutting = cutting;
    if (!script.empty()) {
      pose.time_s =
          script.back().time_s + travel_time_s(script.back(), pose, {.tip_mm_per_s = speed});
    }
    script.push_back(pose);
  };
  const auto above = [&](TimedPose pose) {
    pose.tip_mm.z = figure.middle_mm.z + clear_mm;
    return pose;
  };
  go(above(point_of(figure, 0, 0, start_rad)), false);
  for (int lap = 0; lap < kLaps; ++lap) {
    go(above(point_of(figure, lap, 0, start_rad)), false);
    for (int i = 0; i <= kPointsPerLap; ++i) {
      go(point_of(figure, lap, static_cast<double>(i) / kPointsPerLap, start_rad), true);
    }
    go(above(script.back()), false);
  }
  return script;
}

}  // namespace kerf::agent
