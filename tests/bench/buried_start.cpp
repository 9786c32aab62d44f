// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/buried_start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "kernel/sculpture.h"
#include "tests/kernel/extremes/carving.h"

namespace kerf::bench {
namespace {

constexpr double kStepMm = 0.03, kTickS = 0.001;
constexpr int kTicks = 100, kSteadyFrom = 40;
constexpr double kTurnPerTick = 0.25 * std::numbers::pi / 180;
constexpr double kPivotMm = 60;
const Vec3 kUp{0, 0, 1};
const ToolPose kStart{{0.0371, 0.0213, -5.03}, kUp};

struct Setup {
  double pitch_mm;
  Rays rays;
  ForceLaw law;
};

/// Worst and steady magnitudes over the ticks of one motion.
struct Felt {
  double worst_n = 0, steady_n = 0, worst_nmm = 0, steady_nmm = 0;
};
/// The magnitudes as ratios.
struct Ratio {
  double force = 0, torque = 0;
};

Sculpture block(const Setup& setup, const Tool& tool) {
  Sculpture sculpture = *Sculpture::create({.stock = BoxStock{{-12, -12, -16}, {12, 12, 0}},
                                            .rays = setup.rays,
                                            .pitch_mm = setup.pitch_mm,
                                            .tolerance_mm = 0.001,
                                            .force = {.law = setup.law, .pivot_mm = kPivotMm}});
  sculpture.apply(DefineTool{1, tool}).value();
  return sculpture;
}

/// Moves a tool in ticks along the poses that `at` returns for tick numbers.
template <class At>
Felt follow(Sculpture& s, ToolId tool, const At& at) {
  Felt felt;
  for (int i = 0; i < kTicks; ++i) {
    const Wrench w = s.apply(MoveTool{tool, at(i), at(i + 1), kTickS}).value().wrench;
    const double force = length(w.force_n), torque = length(w.torque_nmm);
    felt.worst_n = std::max(felt.worst_n, force);
    felt.worst_nmm = std::max(felt.worst_nmm, torque);
    if (i < kSteadyFrom) continue;
    felt.steady_n += force / (kTicks - kSteadyFrom);
    felt.steady_nmm += torque / (kTicks - kSteadyFrom);
  }
  return felt;
}

auto along(Vec3 direction) {
  return [direction](int i) {
    return ToolPose{kStart.tip_mm + direction * (i * kStepMm), kStart.axis};
  };
}

/// Returns the ratios to the steady force and torque of `steady`. A cut along the axis has no
/// torque of its own, so the scale is the force times `radius_mm`, if that is larger.
Ratio ratio(const Felt& felt, const Felt& steady, double radius_mm) {
  return {felt.worst_n / steady.steady_n,
          felt.worst_nmm / std::max(steady.steady_nmm, steady.steady_n * radius_mm)};
}

/// The motions of one row of the table.
constexpr std::array kMotions{"slot", "plunge", "turn", "lift", "tremor", "change"};
using Row = std::array<Ratio, kMotions.size()>;

Row measure(const Setup& setup, const Tool& tool, const Tool& larger) {
  const double radius = tool.radius_mm;
  Felt slot;
  Row row;
  for (const double degrees : {0.0, 30.0}) {
    const double a = degrees * std::numbers::pi / 180;
    Sculpture s = block(setup, tool);
    slot = follow(s, 1, along({std::cos(a), std::sin(a), 0}));
    const Ratio r = ratio(slot, slot, radius);
    row[0] = {std::max(row[0].force, r.force), std::max(row[0].torque, r.torque)};
  }
  {
    Sculpture s = block(setup, tool);
    const Felt felt = follow(s, 1, along({0, 0, -1}));
    row[1] = ratio(felt, felt, radius);
  }
  {
    Sculpture s = block(setup, tool);
    const Felt felt = follow(s, 1, [](int i) {
      const double a = i * kTurnPerTick;
      return ToolPose{kStart.tip_mm, {std::sin(a), 0, std::cos(a)}};
    });
    row[2] = ratio(felt, felt, radius);
  }
  {
    // A tool with an undercut also cuts upwards.
    Sculpture s = block(setup, tool);
    const Felt felt = follow(s, 1, along({0, 0, 1}));
    row[3] = ratio(felt, felt.steady_n > slot.steady_n ? felt : slot, radius);
  }
  {
    Sculpture s = block(setup, tool);
    row[4] = ratio(follow(s, 1, along({1e-9 / kStepMm, 0, 0})), slot, radius);
  }
  {
    Sculpture s = block(setup, tool);
    s.apply(DefineTool{2, larger}).value();
    const ToolPose entry{{-20, kStart.tip_mm.y, kStart.tip_mm.z}, kUp};
    s.apply(MoveTool{1, entry, kStart, 1}).value();
    const Felt felt = follow(s, 2, along({1, 0, 0}));
    row[5] = ratio(felt, felt, larger.radius_mm);
  }
  return row;
}

}  // namespace

void print_buried_starts(double pitch_mm) {
  std::printf(
      "\nStarts inside stock, %.2f mm deep: worst force and torque / those of the steady cut "
      "(lift and tremor of 1e-9 mm: at least the slot's). change: a tool 1.67 times as large in a "
      "slot.\n",
      -kStart.tip_mm.z);
  std::printf("%-11s %-9s %-9s", "tool", "rays", "law");
  for (const char* motion : kMotions) std::printf(" %11s", motion);
  std::printf("\n");
  const auto tools = test::every_tool(0.6), larger = test::every_tool(1);
  double worst = 0;
  for (std::size_t n = 0; n < tools.size(); ++n) {
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      for (const ForceLaw law : {ForceLaw::kSpecificEnergy, ForceLaw::kDexelRemovalRate}) {
        const Row row = measure({pitch_mm, rays, law}, tools[n].tool, larger[n].tool);
        std::printf("%-11s %-9s %-9s", tools[n].name.c_str(), to_string(rays),
                    law == ForceLaw::kSpecificEnergy ? "specific" : "drr");
        for (const Ratio& r : row) {
          std::printf(" %5.2f %5.2f", r.force, r.torque);
          worst = std::max({worst, r.force, r.torque});
        }
        std::printf("\n");
      }
    }
  }
  std::printf("worst %.2f\n", worst);
}

}  // namespace kerf::bench
