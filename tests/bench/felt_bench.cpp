// SPDX-License-Identifier: Apache-2.0
// Measures what a user of the 5-DOF reference device feels in every scene of the repository,
// against what the server computes: the real session and servo in virtual time, the programs of
// kerf-demo and the figure that `--device sim` carves.
//
//   felt_bench [seconds=60]
//
// Means and maxima of the magnitudes, felt of computed; error: rms of the difference of the vectors
// over rms of the computed one, which the server computes for the pose of that tick alone. reduced:
// share of the ticks with a force in which the device outputs less than 95 % of what the agent's
// own replica computes.
#include <cstdio>
#include <cstdlib>

#include "tests/agent/stability/shipped_scenes.h"

int main(int argc, char** argv) {
  using namespace kerf::agent;
  const double seconds = argc > 1 ? std::atof(argv[1]) : 60;
  std::printf("%-36s %-8s %18s %18s %6s %20s %20s %6s %8s %5s\n", "scene", "path", "mean force N",
              "max force N", "error", "mean torque N mm", "max torque N mm", "error", "reduced",
              "trips");
  for (const ShippedScene& scene : shipped_scenes()) {
    const ShippedFeel feel = feel_shipped(scene, seconds);
    const FeltSums &f = feel.server_force, &t = feel.server_torque;
    const double ticks = static_cast<double>(feel.agent.ticks);
    const char* const paths[] = {"figure", "first", "second"};
    std::printf(
        "%-36s %-8s %8.2f of %6.2f %8.2f of %6.2f %5.1f%% %8.1f of %8.1f %8.1f of %8.1f "
        "%5.1f%% %7.1f%% %5llu\n",
        scene.file.c_str(), paths[scene.program], f.felt_mean(), f.computed_mean(), f.felt_peak(),
        f.computed_peak(), 100 * f.error(), t.felt_mean(), t.computed_mean(), t.felt_peak(),
        t.computed_peak(), 100 * t.error(),
        ticks > 0 ? 100 * static_cast<double>(feel.agent.reduced_ticks) / ticks : 0.0,
        static_cast<unsigned long long>(feel.trips));
    std::fflush(stdout);
  }
  return 0;
}
