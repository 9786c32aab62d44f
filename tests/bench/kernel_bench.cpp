// SPDX-License-Identifier: Apache-2.0
// Measures the standard job on one core: moves per second including force and torque, sub-motions,
// removed volume; a bare height-map loop on the three-axis job as an upper bound; and samples of
// one operator at 1 kHz. Usage: kernel_bench [pitch_mm=0.1] [tolerance_mm=0.001]
// [shape=ball|flat|taper|cone_end]

#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/bench/bare_loop.h"
#include "tests/support/standard_job.h"

namespace {

using namespace kerf;

/// Returns the CPU time of this thread, s.
double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + double(t.tv_nsec) * 1e-9;
}

Tool tool_named(const std::string& shape) {
  if (shape == "flat") return *make_tool(FlatShape{10, 50});
  if (shape == "taper") return *make_tool(TaperShape{6, 10, 50});
  if (shape == "cone_end") return *make_tool(ConeEndShape{10, 90, 50});
  return *make_tool(BallShape{10, 50});
}

/// Returns moves per second.
double run(bool five_axis, double pitch_mm, double tolerance_mm, MotionModel model,
           const std::string& shape) {
  SculptureSettings settings = test::standard_settings(pitch_mm, tolerance_mm);
  settings.motion = model;
  auto sculpture = *Sculpture::create(settings);
  sculpture.apply(DefineTool{1, tool_named(shape)}).value();
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
      "%-8s %d-axis %-5s pitch %.3g tol %.3g: %8.0f moves/s, p50 %.1f us, p99 %.1f us, "
      "%.2f sub-motions/move, removed %.3f mm3, hash %016llx\n",
      shape.c_str(), five_axis ? 5 : 3, model == MotionModel::kTight ? "tight" : "paper", pitch_mm,
      tolerance_mm, moves / seconds, move_us[move_us.size() / 2],
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

/// Cuts fresh material at 1 kHz with 0.1 mm and 0.25 degrees per tick.
void run_hand(double pitch_mm, double tolerance_mm) {
  constexpr double kTiltRad = 0.26, kDegree = 0.017453292519943295;
  auto sculpture = *Sculpture::create(test::standard_settings(pitch_mm, tolerance_mm));
  sculpture.apply(DefineTool{1, *make_tool(BallShape{10, 50})}).value();
  const auto pose = [&](int tick) {
    const int row = tick / 900, step = tick % 900;
    const double x = 5 + 0.1 * (row % 2 == 0 ? step : 899 - step), y = 5 + 2.0 * row;
    const double azimuth = tick * 0.25 * kDegree / std::sin(kTiltRad);
    return ToolPose{{x, y, 46},
                    {std::sin(kTiltRad) * std::cos(azimuth), std::sin(kTiltRad) * std::sin(azimuth),
                     std::cos(kTiltRad)}};
  };
  std::vector<double> tick_us;
  for (int tick = 1; tick < 36000; ++tick) {
    if (tick % 900 == 0) continue;
    const double start = cpu_seconds();
    sculpture.apply(MoveTool{1, pose(tick - 1), pose(tick), 0.001}).value();
    tick_us.push_back((cpu_seconds() - start) * 1e6);
  }
  double sum = 0;
  for (const double us : tick_us) sum += us;
  std::ranges::sort(tick_us);
  std::printf(
      "operator at 1 kHz, 0.1 mm and 0.25 degrees per tick: p50 %.1f us, p99 %.1f us, mean %.1f "
      "us: "
      "%.0f operators per core\n",
      tick_us[tick_us.size() / 2], tick_us[tick_us.size() * 99 / 100], sum / double(tick_us.size()),
      1000 / (sum / double(tick_us.size())));
}

}  // namespace

int main(int argc, char** argv) {
  const double pitch_mm = argc > 1 ? std::atof(argv[1]) : 0.1;
  const double tolerance_mm = argc > 2 ? std::atof(argv[2]) : 0.001;
  const std::string shape = argc > 3 ? argv[3] : "ball";
  const double rate = run(false, pitch_mm, tolerance_mm, MotionModel::kTight, shape);
  run(true, pitch_mm, tolerance_mm, MotionModel::kTight, shape);
  if (shape != "ball") return 0;
  std::printf("the bare loop is %.1f times as fast\n", run_bare_loop(pitch_mm) / rate);
  run_hand(pitch_mm, tolerance_mm);
  return 0;
}
