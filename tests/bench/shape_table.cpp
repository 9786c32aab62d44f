// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/shape_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "tests/bench/cpu_clock.h"
#include "tests/kernel/extremes/carving.h"
#include "tests/support/standard_job.h"

namespace kerf::test {
namespace {

/// Motions of each job: three rows of the standard job, and one row of a hand.
constexpr std::size_t kJobMoves = 310, kHandTicks = 899;
/// The looser tolerance that is compared with the table's.
constexpr double kLooseToleranceMm = 0.1;

/// CPU times of the motions of a job, µs.
struct Times {
  std::vector<double> sorted_us;

  double at(double share) const {
    return sorted_us[std::size_t(share * double(sorted_us.size() - 1))];
  }
  double per_second() const {
    double sum = 0;
    for (const double us : sorted_us) sum += us;
    return 1e6 * double(sorted_us.size()) / sum;
  }
};

Times time_job(const Tool& tool, const std::vector<ToolPose>& path, double move_s, double pitch_mm,
               double tolerance_mm, int repetitions) {
  std::vector<double> best(path.size() - 1, 1e300);
  for (int k = 0; k < repetitions; ++k) {
    auto sculpture = *Sculpture::create(standard_settings(pitch_mm, tolerance_mm));
    sculpture.apply(DefineTool{1, tool}).value();
    for (std::size_t i = 1; i < path.size(); ++i) {
      const double start = cpu_seconds();
      sculpture.apply(MoveTool{1, path[i - 1], path[i], move_s}).value();
      best[i - 1] = std::min(best[i - 1], (cpu_seconds() - start) * 1e6);
    }
  }
  std::ranges::sort(best);
  return {std::move(best)};
}

std::vector<ToolPose> first_rows(bool five_axis) {
  std::vector<ToolPose> path = standard_path(five_axis);
  path.resize(kJobMoves + 1);
  return path;
}

/// A hand that cuts fresh material at 1 kHz with 0.1 mm and 0.25 degrees per tick, its axis
/// circling at 15 degrees from upright.
std::vector<ToolPose> hand_path() {
  constexpr double kTiltRad = 0.26, kDegree = 0.017453292519943295;
  std::vector<ToolPose> path;
  for (std::size_t tick = 0; tick <= kHandTicks; ++tick) {
    const double azimuth = double(tick) * 0.25 * kDegree / std::sin(kTiltRad);
    path.push_back({{5 + 0.1 * double(tick), 5, 46},
                    {std::sin(kTiltRad) * std::cos(azimuth), std::sin(kTiltRad) * std::sin(azimuth),
                     std::cos(kTiltRad)}});
  }
  return path;
}

}  // namespace

void print_shape_table(double pitch_mm, double tolerance_mm, int repetitions,
                       const std::string& only) {
  std::printf("Pitch %g mm, tolerance %g mm, CPU time, best of %d:\n", pitch_mm, tolerance_mm,
              repetitions);
  std::printf(
      "translation of 1 mm, tick of a hand of 0.1 mm and 0.25 degrees, us; moves/s; ratio of the "
      "latter for a tolerance of %g mm:\n\n",
      kLooseToleranceMm);
  std::printf(
      "| tool | 1 mm, median | p99 | x ball | tick, median | p99 | x ball | 3 axes | 5 axes | "
      "looser |\n|---|---|---|---|---|---|---|---|---|---|\n");
  double ball_translation = 0, ball_tick = 0;
  for (const NamedTool& t : every_tool()) {
    if (!only.empty() && t.name != only) continue;
    const auto times = [&](const std::vector<ToolPose>& path, double move_s) {
      return time_job(t.tool, path, move_s, pitch_mm, tolerance_mm, repetitions);
    };
    const Times three = times(first_rows(false), 0.01), five = times(first_rows(true), 0.01);
    const Times hand = times(hand_path(), 0.001);
    const Times loose =
        time_job(t.tool, first_rows(true), 0.01, pitch_mm, kLooseToleranceMm, repetitions);
    if (t.name == "ball") {
      ball_translation = three.at(0.5);
      ball_tick = hand.at(0.5);
    }
    const auto ratio = [](double us, double ball_us) { return ball_us > 0 ? us / ball_us : 0; };
    std::printf("| %s | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f | %.0f | %.0f | %.2f |\n",
                t.name.c_str(), three.at(0.5), three.at(0.99),
                ratio(three.at(0.5), ball_translation), hand.at(0.5), hand.at(0.99),
                ratio(hand.at(0.5), ball_tick), three.per_second(), five.per_second(),
                loose.per_second() / five.per_second());
    std::fflush(stdout);
  }
}

}  // namespace kerf::test
