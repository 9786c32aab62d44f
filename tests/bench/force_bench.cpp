// SPDX-License-Identifier: Apache-2.0
// Measures the force at constant engagement: slots of constant depth and plunges at 30 mm/s with
// ball and flat end mills, in several directions of the grid. An ideal force is constant over the
// ticks, and independent of the tick rate and of the pitch. Then the force of motions that start
// inside stock, the work of swivels about points of the tool's axis, light side cuts, the cost of
// the force laws, and the mechanistic law against published recordings, which has pitches of its
// own. Prints six tables. Usage: force_bench [pitch_mm=0.1]
// [steady|starts|swivels|light|cost|published]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "kernel/sculpture.h"
#include "tests/bench/buried_start.h"
#include "tests/bench/law_cost.h"
#include "tests/bench/light_cut.h"
#include "tests/bench/published_force.h"
#include "tests/kernel/extremes/carving.h"
#include "tests/support/swivel.h"

namespace {

using namespace kerf;

constexpr double kSpeedMmS = 30;
constexpr double kRateHz = 1000;
constexpr double kRadiusMm = 3;
constexpr double kDepthMm = 2.03;
constexpr double kMeasuredMm = 6;
constexpr double kPivotMm = 60;

struct Setup {
  bool ball = true;
  Rays rays = Rays::kDexel;
  ForceLaw law = ForceLaw::kSpecificEnergy;
  double pitch_mm = 0.1;
  double rate_hz = kRateHz;
};

/// One cut of constant engagement: the tool is sunk at `start` without force, cuts until the
/// engagement is constant, and is then measured.
struct Cut {
  std::string name;
  Vec3 start, direction;
};

Cut slot(double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  const Vec3 direction{std::cos(a), std::sin(a), 0};
  char name[32];
  std::snprintf(name, sizeof name, "slot %.0f", degrees);
  return {name, Vec3{0.0371, 0.0213, -kDepthMm} - direction * 7, direction};
}

Cut plunge() { return {"plunge", {0.0371, 0.0213, -3.513}, {0, 0, -1}}; }

struct Statistics {
  Vec3 force, torque;                          ///< means
  double force_ripple = 0, torque_ripple = 0;  ///< rms of the deviation / |mean force|, / its lever
  double delay_mm = 0;                         ///< mean travel by which the force lags the cut
};

/// Returns the rms deviation from the mean, relative to `scale`.
double ripple(const std::vector<Vec3>& values, Vec3 mean, double scale) {
  double sum = 0;
  for (const Vec3& v : values) sum += dot(v - mean, v - mean);
  return std::sqrt(sum / double(values.size())) / scale;
}

Vec3 mean(const std::vector<Vec3>& values) {
  Vec3 sum;
  for (const Vec3& v : values) sum = sum + v;
  return sum * (1 / double(values.size()));
}

Sculpture block(const Setup& setup) {
  return *Sculpture::create({.stock = BoxStock{{-14, -14, -16}, {14, 14, 0}},
                             .rays = setup.rays,
                             .pitch_mm = setup.pitch_mm,
                             .tolerance_mm = 0.001,
                             .force = {.law = setup.law, .pivot_mm = kPivotMm}});
}

Statistics measure(const Setup& setup, const Cut& cut) {
  Sculpture sculpture = block(setup);
  const double d = 2 * kRadiusMm;
  const ToolShape shape = setup.ball ? ToolShape{BallShape{d, 40}} : ToolShape{FlatShape{d, 40}};
  sculpture.apply(DefineTool{1, *make_tool(shape)}).value();
  const Vec3 up{0, 0, 1};
  const Vec3 above{cut.start.x, cut.start.y, 1};
  sculpture.apply(MoveTool{1, {above, up}, {cut.start, up}, 1, false}).value();
  const double step_mm = kSpeedMmS / setup.rate_hz;
  const int lead = int(std::lround(4 / step_mm));
  const int ticks = int(std::lround(kMeasuredMm / step_mm));
  std::vector<Vec3> forces, torques;
  std::vector<double> areas;
  for (int i = 0; i < lead + ticks; ++i) {
    const Vec3 from = cut.start + cut.direction * (i * step_mm);
    const Vec3 to = cut.start + cut.direction * ((i + 1) * step_mm);
    const MotionResult r =
        sculpture.apply(MoveTool{1, {from, up}, {to, up}, 1 / setup.rate_hz}).value();
    areas.push_back(r.cutting.engaged_area_mm2);
    if (i < lead) continue;
    forces.push_back(r.wrench.force_n);
    torques.push_back(r.wrench.torque_nmm);
  }
  Statistics s{mean(forces), mean(torques)};
  // A plunge has no mean torque; its ripple is relative to the force times the radius.
  const double push = length(s.force);
  const double torque = std::max(length(s.torque), push * kRadiusMm);
  s.force_ripple = ripple(forces, s.force, push);
  s.torque_ripple = ripple(torques, s.torque, torque);
  // The force starts at zero: the impulse missing until the engagement is constant gives the delay.
  double area = 0;
  for (int i = lead; i < lead + ticks; ++i) area += areas[std::size_t(i)] / ticks;
  for (int i = 0; i < lead; ++i) s.delay_mm += step_mm * (1 - areas[std::size_t(i)] / area);
  return s;
}

/// Returns the greatest relative difference between the mean forces and the first of them.
double spread(const std::vector<Vec3>& forces) {
  double worst = 0;
  for (const Vec3& f : forces) {
    worst = std::max(worst, length(f - forces.front()) / length(forces.front()));
  }
  return worst;
}

void row(const Setup& setup, const Cut& cut) {
  const Statistics s = measure(setup, cut);
  std::vector<Vec3> by_rate{s.force}, by_pitch{s.force};
  for (const double rate_hz : {250.0, 500.0, 2000.0, 4000.0}) {
    Setup other = setup;
    other.rate_hz = rate_hz;
    by_rate.push_back(measure(other, cut).force);
  }
  Setup finer = setup;
  finer.pitch_mm /= 2;
  by_pitch.push_back(measure(finer, cut).force);
  std::printf("%-5s %-9s %-9s %-9s %9.3f %8.2f %8.2f %8.2f %8.2f %8.3f\n",
              setup.ball ? "ball" : "flat", to_string(setup.rays),
              setup.law == ForceLaw::kSpecificEnergy ? "specific" : "drr", cut.name.c_str(),
              length(s.force), 100 * s.force_ripple, 100 * s.torque_ripple, 100 * spread(by_rate),
              100 * spread(by_pitch), s.delay_mm);
}

void print_constant_engagement(double pitch_mm) {
  const std::vector<Cut> cuts{slot(0), slot(30), slot(45), slot(90), plunge()};
  std::printf(
      "Constant engagement, %.0f mm/s, pitch %.3g mm, %.0f Hz, tools of %.0f mm, slots %.2f mm "
      "deep. Ripple: rms / mean.\n",
      kSpeedMmS, pitch_mm, kRateHz, 2 * kRadiusMm, kDepthMm);
  std::printf("%-5s %-9s %-9s %-9s %9s %8s %8s %8s %8s %8s\n", "tool", "rays", "law", "cut",
              "force_N", "ripple%", "torque%", "rates%", "pitch%", "delay_mm");
  for (const bool ball : {true, false}) {
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      for (const ForceLaw law : {ForceLaw::kSpecificEnergy, ForceLaw::kDexelRemovalRate}) {
        for (const Cut& cut : cuts) row({ball, rays, law, pitch_mm}, cut);
      }
    }
  }
}

void print_swivels(double pitch_mm) {
  constexpr double kAboveTipMm[] = {-5, 0, 2, 5, 9, 30};
  std::printf(
      "\nSwivels of 14 degrees, 10 mm deep, about a point of the axis at a height above the tip "
      "(mm), until nothing is pending, specific energy: work / (u V).\n");
  std::printf("%-11s %-9s", "tool", "rays");
  for (const double height : kAboveTipMm) std::printf(" %6.0f", height);
  std::printf("\n");
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    double worst = 0;
    for (const auto& named : test::every_tool(0.6)) {
      std::printf("%-11s %-9s", named.name.c_str(), to_string(rays));
      for (const double height : kAboveTipMm) {
        const double share = test::work_over_energy(
            {.tool = named.tool, .rays = rays, .pitch_mm = pitch_mm, .above_tip_mm = height});
        worst = std::max(worst, std::abs(share - 1));
        std::printf(" %6.3f", share);
      }
      std::printf("\n");
    }
    std::printf("%s: worst deviation %.1f %%\n", to_string(rays), 100 * worst);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const double pitch_mm = argc > 1 ? std::atof(argv[1]) : 0.1;
  const std::string table = argc > 2 ? argv[2] : "";
  const auto wants = [&](const char* name) { return table.empty() || table == name; };
  if (wants("steady")) print_constant_engagement(pitch_mm);
  if (wants("starts")) kerf::bench::print_buried_starts(pitch_mm);
  if (wants("swivels")) print_swivels(pitch_mm);
  if (wants("light")) kerf::bench::print_light_cuts(pitch_mm);
  if (wants("cost")) kerf::bench::print_law_costs(pitch_mm);
  if (wants("published")) kerf::bench::print_published_forces();
  return 0;
}
