// SPDX-License-Identifier: Apache-2.0
// Measures the standard job on one core: moves per second including force and torque, sub-motions,
// removed volume; a bare height-map loop on the three-axis job as an upper bound; and a table over
// all tool shapes (shape_table.h). Usage: kernel_bench [pitch_mm=0.1] [tolerance_mm=0.001]
// [shape=all|ball|flat|…] [repetitions=3]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/bench/bare_loop.h"
#include "tests/bench/cpu_clock.h"
#include "tests/bench/shape_table.h"
#include "tests/support/standard_job.h"

namespace {

using namespace kerf;

using test::cpu_seconds;

/// Returns moves per second.
double run(bool five_axis, double pitch_mm, double tolerance_mm) {
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
  return moves / seconds;
}

double run_bare_loop(double pitch_mm) {
  const std::vector<ToolPose> path = test::standard_path(false);
  double best = 1e300, removed = 0;
  for (int repetition = 0; repetition < 3; ++repetition) {
    test::BareLoop loop(pitch_mm);
    const double start = cpu_seconds();
    for (std::size_t i = 1; i < path.size(); ++i) loop.move(path[i - 1].tip_mm, path[i].tip_mm);
    best = std::min(best, cpu_seconds() - start);
    removed = loop.removed_mm3();
  }
  const double rate = double(path.size() - 1) / best;
  std::printf("bare loop 3-axis: %8.0f moves/s, removed %.0f mm3\n", rate, removed);
  return rate;
}

}  // namespace

int main(int argc, char** argv) {
  const double pitch_mm = argc > 1 ? std::atof(argv[1]) : 0.1;
  const double tolerance_mm = argc > 2 ? std::atof(argv[2]) : 0.001;
  const std::string shape = argc > 3 ? argv[3] : "all";
  const int repetitions = argc > 4 ? std::atoi(argv[4]) : 3;
  if (shape == "all") {
    const double rate = run(false, pitch_mm, tolerance_mm);
    run(true, pitch_mm, tolerance_mm);
    std::printf("the bare loop is %.1f times as fast\n", run_bare_loop(pitch_mm) / rate);
  }
  test::print_shape_table(pitch_mm, tolerance_mm, repetitions, shape == "all" ? "" : shape);
  return 0;
}
