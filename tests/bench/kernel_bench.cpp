// SPDX-License-Identifier: Apache-2.0
// Measures the standard job on one core: moves per second including force and torque, sub-motions,
// removed volume; a table over all tool shapes (shape_table.h); and one over pitches, fields and
// axes, with bare loops over a height map for comparison (growth_table.h). Usage: kernel_bench
// [pitch_mm=0.1] [tolerance_mm=0.001] [shape=all|ball|flat|…] [repetitions=3]

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/bench/cpu_clock.h"
#include "tests/bench/growth_table.h"
#include "tests/bench/shape_table.h"
#include "tests/support/standard_job.h"

namespace {

using namespace kerf;

using test::cpu_seconds;

/// Prints the speed of the standard job of a ball.
void run(bool five_axis, double pitch_mm, double tolerance_mm) {
  auto sculpture = *Sculpture::create(test::standard_settings(pitch_mm, tolerance_mm));
  sculpture.apply(DefineTool{1, *make_tool(BallShape{10, 50})}).value();
  const std::vector<ToolPose> path = test::standard_path(five_axis);
  std::vector<double> move_us;
  const double start = cpu_seconds();
  double last = start;
  for (std::size_t i = 1; i < path.size(); ++i) {
    sculpture.apply(MoveTool{1, path[i - 1], path[i], 0.01}).value();
    const double now = cpu_seconds();
    move_us.push_back((now - last) * 1e6);
    last = now;
  }
  const double seconds = last - start;
  std::ranges::sort(move_us);
  const auto moves = double(move_us.size());
  std::printf(
      "ball %d-axis pitch %.3g tol %.3g: %8.0f moves/s, p50 %.1f us, p99 %.1f us, "
      "%.2f sub-motions/move, removed %.3f mm3, hash %016llx\n",
      five_axis ? 5 : 3, pitch_mm, tolerance_mm, moves / seconds, move_us[move_us.size() / 2],
      move_us[move_us.size() * 99 / 100], double(sculpture.sub_motions()) / moves,
      sculpture.removed_volume_mm3(), static_cast<unsigned long long>(sculpture.state_hash()));
}

}  // namespace

int main(int argc, char** argv) {
  const double pitch_mm = argc > 1 ? std::atof(argv[1]) : 0.1;
  const double tolerance_mm = argc > 2 ? std::atof(argv[2]) : 0.001;
  const std::string shape = argc > 3 ? argv[3] : "all";
  const int repetitions = argc > 4 ? std::atoi(argv[4]) : 3;
  if (shape == "all") {
    run(false, pitch_mm, tolerance_mm);
    run(true, pitch_mm, tolerance_mm);
  }
  test::print_shape_table(pitch_mm, tolerance_mm, repetitions, shape == "all" ? "" : shape);
  if (shape == "all") test::print_growth_table(tolerance_mm, repetitions);
  return 0;
}
