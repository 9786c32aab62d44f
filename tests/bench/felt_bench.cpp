// SPDX-License-Identifier: Apache-2.0
// Measures the force that a user of the 5-DOF reference device feels in every scene of the
// repository, compared with the force that the server computes: the real session and servo in
// virtual time, the programs of kerf-demo and the figure that `--device sim` carves.
//
//   felt_bench [seconds=60]          every scene, then cuts by hands that yield
//   felt_bench hands                 the latter only
//   felt_bench 60 NAME               scenes whose name contains NAME
//
// Means and maxima of the magnitudes, felt relative to computed. error: rms of the difference of
// the vectors over rms of the computed one, which the server computes for the pose of that tick
// alone. late: the error of the server's own results one tick late, the earliest that a servo at 1
// kHz can have them. reduced: share of the ticks with a force in which the device outputs less than
// 95 % of the force that the agent's own replica computes. chatter: rms of the tip's velocity minus
// that of the hand's target, of which up to 9 mm/s comes from the hand yielding to 1 N that turns
// along the half circle. The last table is for a circle of 10 mm radius, around which soft hands
// cannot pull the tool.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/agent/stability/held_cut.h"
#include "tests/agent/stability/shipped_scenes.h"

namespace {

using namespace kerf::agent;

void print_scenes(double seconds, std::string_view name) {
  std::printf("%-36s %-8s %18s %18s %6s %6s %20s %20s %6s %6s %8s %5s\n", "scene", "path",
              "mean force N", "max force N", "error", "late", "mean torque N mm", "max torque N mm",
              "error", "late", "reduced", "trips");
  for (const ShippedScene& scene : shipped_scenes()) {
    if (!scene.file.contains(name)) continue;
    const ShippedFeel feel = feel_shipped(scene, seconds);
    const FeltSums &f = feel.server_force, &t = feel.server_torque;
    const double ticks = static_cast<double>(feel.agent.ticks);
    const char* const paths[] = {"figure", "first", "second"};
    std::printf(
        "%-36s %-8s %8.2f of %6.2f %8.2f of %6.2f %5.1f%% %5.1f%% %8.1f of %8.1f %8.1f of "
        "%8.1f %5.1f%% %5.1f%% %7.1f%% %5llu\n",
        scene.file.c_str(), paths[scene.program], f.felt_mean(), f.computed_mean(), f.felt_peak(),
        f.computed_peak(), 100 * f.error(), 100 * feel.late_force.error(), t.felt_mean(),
        t.computed_mean(), t.felt_peak(), t.computed_peak(), 100 * t.error(),
        100 * feel.late_torque.error(),
        ticks > 0 ? 100 * static_cast<double>(feel.agent.reduced_ticks) / ticks : 0.0,
        static_cast<unsigned long long>(feel.trips));
    std::fflush(stdout);
  }
}

/// Prints the forces on hands that yield, as they cut a slot along a line and a circle.
void print_hands(bool mechanistic, double newtons, double mm_per_s, double radius_mm = 30) {
  std::printf(
      "\n%s, %.0f N, %.0f mm/s, radius %.0f mm\n%-8s %8s %8s %8s %18s %7s %7s %14s %6s %6s\n",
      mechanistic ? "mechanistic" : "specific_energy", newtons, mm_per_s, radius_mm, "latency",
      "kg", "kg m2", "N/mm", "mean force N", "error", "torque", "chatter mm/s", "mJ", "trips");
  const auto row = [=](const PlantMechanics& hand) {
    const HeldCutOutcome cut = cut_by_hand({.mechanics = hand,
                                            .newtons = newtons,
                                            .mm_per_s = mm_per_s,
                                            .radius_mm = radius_mm,
                                            .mechanistic = mechanistic});
    std::printf("%5.0f ms %8.2f %8.0e %8.1f %8.2f of %6.2f %6.1f%% %6.1f%% %14.1f %6.2f %6llu\n",
                static_cast<double>(hand.latency_us) / 1000, hand.mass_kg, hand.inertia_kg_m2,
                hand.hand_n_per_mm, cut.force.felt_mean(), cut.force.computed_mean(),
                100 * cut.force.error(), 100 * cut.torque.error(), cut.chatter_mm_per_s,
                cut.returned_mj, static_cast<unsigned long long>(cut.trips));
    std::fflush(stdout);
  };
  for (const std::uint64_t latency_us : {0U, 1000U, 3000U}) {
    for (const double inertia_kg_m2 : {1e-5, 3e-5, 2e-4}) {
      for (const double mass_kg : {0.05, 0.3}) {
        for (const double n_per_mm : {0.5, 2.0}) {
          row({.mass_kg = mass_kg,
               .inertia_kg_m2 = inertia_kg_m2,
               .hand_n_per_mm = n_per_mm,
               .hand_nmm_per_rad = 670 * n_per_mm,
               .latency_us = latency_us});
        }
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view part = argc > 1 ? argv[1] : "60";
  const std::string_view name = argc > 2 ? argv[2] : "";
  if (part != "hands") print_scenes(std::atof(part.data()), name);
  if (!name.empty()) return 0;
  print_hands(false, 1, 20);
  print_hands(true, 1, 20);
  print_hands(false, 1, 5);
  print_hands(false, 3, 20);
  print_hands(false, 1, 20, 10);
  return 0;
}
