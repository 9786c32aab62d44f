// SPDX-License-Identifier: Apache-2.0
// Measures the felt force of strokes that hands make: pecking, stippling, hatching, circles,
// drilling and slots, with ten tools, upright and tilted. Real session, servo and copy of the
// block, in virtual time.
//
//   stroke_bench                hands that do not yield: every stroke, rate and tool, three tilts
//   stroke_bench live           firm and soft hands that yield (0.3 kg), three tools
//   stroke_bench encoders       hands that do not yield, through encoders of 0.01 to 0.055 mm
//   stroke_bench NAME           as the first, only strokes whose name contains NAME
//
// error: rms of the difference between the displayed wrench and the server's result for the pose of
// that tick, over rms of the latter. late: the error of the server's results one tick late, the
// earliest possible. beyond: error minus late. soft: share of the ticks in which the coupling of
// the cut was soft.
#include <algorithm>
#include <cstdio>
#include <string_view>

#include "tests/agent/stability/stroke_cut.h"

namespace {

using namespace kerf::agent;

constexpr double kTilts[] = {0, 0.25, 0.5};

struct Worst {
  double force = 0, torque = 0, returned_mj = 0;
  int above = 0, runs = 0;
  unsigned long long trips = 0;

  void add(const StrokeOutcome& cut, double limit) {
    const double f = beyond(cut.force, cut.late_force), t = beyond(cut.torque, cut.late_torque);
    force = std::max(force, f);
    torque = std::max(torque, t);
    returned_mj = std::max(returned_mj, cut.returned_mj);
    above += f > limit || t > limit ? 1 : 0;
    trips += cut.trips;
    ++runs;
  }
  static double beyond(const FeltSums& shown, const FeltSums& late) {
    return std::max(0.0, shown.error() - late.error());
  }
  void print(double limit) const {
    std::printf(
        "worst beyond a tick: force %.1f %%, torque %.1f %%; %d of %d runs above %.0f %%; "
        "%.2f mJ; %llu trips\n",
        100 * force, 100 * torque, above, runs, 100 * limit, returned_mj, trips);
  }
};

void print_head() {
  std::printf("%-12s %5s %4s %5s %18s %13s %13s %13s %6s %8s %6s\n", "stroke", "rate", "tool",
              "tilt", "mean force N", "error F, T %", "late F, T %", "beyond F, T %", "soft",
              "reduced", "trips");
}

void run(const StrokeCut& cut, double limit, Worst& worst) {
  const StrokeOutcome o = cut_stroke(cut);
  worst.add(o, limit);
  std::printf(
      "%-12s %5.1f %4zu %5.2f %8.3f of %6.3f %6.1f %6.1f %6.1f %6.1f %6.1f %6.1f %5.1f%% "
      "%7.1f%% %6llu\n",
      name_of(cut.stroke), cut.rate, cut.tool, cut.tilt_rad, o.force.felt_mean(),
      o.force.computed_mean(), 100 * o.force.error(), 100 * o.torque.error(),
      100 * o.late_force.error(), 100 * o.late_torque.error(),
      100 * Worst::beyond(o.force, o.late_force), 100 * Worst::beyond(o.torque, o.late_torque),
      100 * o.soft_share, 100 * o.reduced_share, static_cast<unsigned long long>(o.trips));
  std::fflush(stdout);
}

void stiff_hands(std::string_view name) {
  constexpr double kLimit = 0.02;
  Worst worst;
  print_head();
  for (const Stroke stroke : kStrokes) {
    if (!std::string_view(name_of(stroke)).contains(name)) continue;
    for (const double rate : rates_of(stroke)) {
      for (std::size_t tool = 0; tool < std::size(kStrokeTools); ++tool) {
        for (const double tilt : kTilts) {
          run({.stroke = stroke, .rate = rate, .tool = tool, .tilt_rad = tilt}, kLimit, worst);
        }
      }
    }
  }
  worst.print(kLimit);
}

void live_hands() {
  constexpr double kLimit = 0.10;
  Worst worst;
  for (const double n_per_mm : {2.0, 0.5}) {
    for (const double damping : {0.3, 0.7}) {
      for (const std::uint64_t latency_us : {0U, 1000U}) {
        std::printf("\n%.1f N/mm, damping ratio %.1f, %.0f ms\n", n_per_mm, damping,
                    static_cast<double>(latency_us) / 1000);
        print_head();
        for (const Stroke stroke : kStrokes) {
          for (const double rate : rates_of(stroke)) {
            for (const std::size_t tool : {0UL, 1UL, 6UL}) {
              run({.stroke = stroke,
                   .rate = rate,
                   .tool = tool,
                   .live = PlantMechanics{.mass_kg = 0.3,
                                          .inertia_kg_m2 = 2e-4,
                                          .hand_n_per_mm = n_per_mm,
                                          .hand_nmm_per_rad = 670 * n_per_mm,
                                          .damping_ratio = damping,
                                          .latency_us = latency_us}},
                  kLimit, worst);
            }
          }
        }
      }
    }
  }
  worst.print(kLimit);
}

void encoders() {
  constexpr double kLimit = 0.05;
  Worst worst;
  for (const double quantum_mm : {0.01, 0.023, 0.055}) {
    std::printf("\n%.3f mm\n", quantum_mm);
    print_head();
    for (const Stroke stroke : kStrokes) {
      for (const double rate : rates_of(stroke)) {
        for (const std::size_t tool : {0UL, 1UL}) {
          run({.stroke = stroke, .rate = rate, .tool = tool, .quantum_mm = quantum_mm}, kLimit,
              worst);
        }
      }
    }
  }
  worst.print(kLimit);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view part = argc > 1 ? argv[1] : "";
  if (part == "live") {
    live_hands();
  } else if (part == "encoders") {
    encoders();
  } else {
    stiff_hands(part);
  }
  return 0;
}
