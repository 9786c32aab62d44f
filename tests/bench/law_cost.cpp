// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/law_cost.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "kernel/sculpture.h"
#include "tests/bench/cpu_clock.h"

namespace kerf::bench {
namespace {

constexpr double kStepMm = 0.03, kTickS = 0.001, kDepthMm = 2.03;
constexpr int kTicks = 300, kRounds = 9;
const Vec3 kUp{0, 0, 1};

/// A computation that is measured in a tick.
struct Variant {
  std::string name;
  bool felt = true;
  ForceSettings force;
};

ForceSettings mechanistic(double rpm, const EdgeCoefficients& exponents) {
  return ForceSettings{.law = ForceLaw::kMechanistic,
                       .milling = {.spindle_rpm = rpm,
                                   .cut_n_per_mm2 = {767, 169, 222},
                                   .edge_n_per_mm = {27.7, 26.6, 0.7},
                                   .chip_exponents = exponents}};
}

std::vector<Variant> variants() {
  ForceSettings none, drr;
  drr.law = ForceLaw::kDexelRemovalRate;
  // At 12000/min two teeth pass 400 times a second, which is above the band of 250 Hz, and at
  // 2400/min 80 times.
  return {{"specific_energy", true, none},
          {"no force", false, none},
          {"drr", true, drr},
          {"mechanistic, means", true, mechanistic(12000, {})},
          {"mechanistic, Kienzle", true, mechanistic(12000, in_all_directions(0.3))},
          {"mechanistic, 3 exponents", true, mechanistic(12000, {0.25, 0.4, 0.1})},
          {"mechanistic, 3 harmonics", true, mechanistic(2400, {})}};
}

/// Returns microseconds of CPU per tick.
double us_per_tick(const Tool& tool, Rays rays, double pitch_mm, const Variant& v) {
  Sculpture block = *Sculpture::create({.stock = BoxStock{{-12, -12, -8}, {12, 12, 0}},
                                        .rays = rays,
                                        .pitch_mm = pitch_mm,
                                        .tolerance_mm = 0.001,
                                        .keep_normals = false,
                                        .force = v.force});
  block.apply(DefineTool{1, tool}).value();
  const auto at = [](int i) { return ToolPose{{-4.04 + i * kStepMm, 0.0213, -kDepthMm}, kUp}; };
  block.apply(MoveTool{1, at(-400), at(0), 1, false}).value();
  const double start = test::cpu_seconds();
  for (int i = 0; i < kTicks; ++i)
    block.apply(MoveTool{1, at(i), at(i + 1), kTickS, v.felt}).value();
  return (test::cpu_seconds() - start) / kTicks * 1e6;
}

}  // namespace

void print_law_costs(double pitch_mm) {
  const std::vector<Variant> all = variants();
  std::printf(
      "\nA tick of %.2f mm in a slot %.2f mm deep, pitch %.3g mm: CPU time (us), least of %d "
      "rounds, and over specific_energy's.\n%-26s",
      kStepMm, kDepthMm, pitch_mm, kRounds, "");
  struct Case {
    const char* name;
    Tool tool;
    Rays rays;
  };
  std::vector<Case> cases;
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    const char* field = rays == Rays::kDexel ? "1" : "3";
    cases.push_back({field, *make_tool(FlatShape{6, 30}), rays});
    cases.push_back({field, *make_tool(BallShape{12, 30}), rays});
  }
  for (const Case& c : cases)
    std::printf("  %s mm, %s field%s", c.tool.radius_mm < 4 ? "flat 6" : "ball 12", c.name,
                c.rays == Rays::kDexel ? " " : "s");
  std::printf("\n");
  std::vector<std::array<double, 4>> least(all.size());
  for (auto& row : least) row.fill(1e9);
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t c = 0; c < cases.size(); ++c)
      for (std::size_t v = 0; v < all.size(); ++v)
        least[v][c] =
            std::min(least[v][c], us_per_tick(cases[c].tool, cases[c].rays, pitch_mm, all[v]));
  for (std::size_t v = 0; v < all.size(); ++v) {
    std::printf("%-26s", all[v].name.c_str());
    for (std::size_t c = 0; c < cases.size(); ++c)
      std::printf("  %8.1f  %5.2f   ", least[v][c], least[v][c] / least[0][c]);
    std::printf("\n");
  }
}

}  // namespace kerf::bench
