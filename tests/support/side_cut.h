// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "kernel/sculpture.h"

namespace kerf::test {

/// A side cut of constant engagement: a flat mill follows a wall that it has cut before, offset by
/// the radial engagement.
struct SideCut {
  double radial_mm = 1;
  double depth_mm = 2.03;
  double diameter_mm = 6;
  double pitch_mm = 0.1;
  double degrees = 0;  ///< of the feed, against the grid
  Rays rays = Rays::kDexel;
  double measured_mm = 6;
  double step_mm = 0.03;
};

/// Feed directions that tests and bench measure.
inline constexpr double kSideCutDegrees[] = {0, 7, 12, 20, 30, 37, 45};

/// Returns the ripple of the force: rms of its deviation from the mean over the mean.
inline double side_cut_ripple(const SideCut& cut) {
  Sculpture sculpture = *Sculpture::create({.stock = BoxStock{{-16, -16, -4}, {16, 16, 0}},
                                            .rays = cut.rays,
                                            .pitch_mm = cut.pitch_mm,
                                            .tolerance_mm = 0.001});
  sculpture.apply(DefineTool{1, *make_tool(FlatShape{cut.diameter_mm, 40})}).value();
  const double a = cut.degrees * std::numbers::pi / 180;
  const Vec3 feed{std::cos(a), std::sin(a), 0}, side{-std::sin(a), std::cos(a), 0};
  const Vec3 up{0, 0, 1};
  const Vec3 start = Vec3{0.0371, 0.0213, -cut.depth_mm} - feed * 5;
  const double lead_mm = 2 + 4 * cut.pitch_mm;
  sculpture
      .apply(
          MoveTool{1, {start - feed * 9, up}, {start + feed * (cut.measured_mm + 9), up}, 1, false})
      .value();
  const Vec3 offset = start + side * cut.radial_mm;
  const int lead = int(std::lround(lead_mm / cut.step_mm));
  const int ticks = int(std::lround(cut.measured_mm / cut.step_mm));
  std::vector<Vec3> forces;
  sculpture.apply(MoveTool{1, {offset, up}, {offset, up}, 1, false}).value();
  for (int i = 0; i < lead + ticks; ++i) {
    const Vec3 from = offset + feed * (i * cut.step_mm);
    const Vec3 to = offset + feed * ((i + 1) * cut.step_mm);
    const auto result =
        sculpture.apply(MoveTool{1, {from, up}, {to, up}, cut.step_mm / 30}).value();
    if (i >= lead) forces.push_back(result.wrench.force_n);
  }
  Vec3 mean;
  for (const Vec3& f : forces) mean = mean + f * (1 / double(forces.size()));
  double square = 0;
  for (const Vec3& f : forces) square += dot(f - mean, f - mean) / double(forces.size());
  return std::sqrt(square) / length(mean);
}

}  // namespace kerf::test
