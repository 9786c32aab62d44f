// The standard job on one core: moves per second with force and torque, end-point error, removed
// volume. Usage: kernel_bench [pitch_mm=0.1] [tolerance_mm=0.001] [shape=ball|flat|taper|cone_end]

#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/support/standard_job.h"

namespace {

using namespace kerf;

/// Time that this thread has had of a core: what other programs take does not count.
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

void run(bool five_axis, double pitch_mm, double tolerance_mm, MotionModel model,
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
}

}  // namespace

int main(int argc, char** argv) {
  const double pitch_mm = argc > 1 ? std::atof(argv[1]) : 0.1;
  const double tolerance_mm = argc > 2 ? std::atof(argv[2]) : 0.001;
  const std::string shape = argc > 3 ? argv[3] : "ball";
  run(false, pitch_mm, tolerance_mm, MotionModel::kTight, shape);
  run(true, pitch_mm, tolerance_mm, MotionModel::kTight, shape);
  return 0;
}
