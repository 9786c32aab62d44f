// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/growth_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "tests/bench/bare_loop.h"
#include "tests/bench/cpu_clock.h"
#include "tests/kernel/extremes/carving.h"
#include "tests/support/standard_job.h"

namespace kerf::test {
namespace {

constexpr std::array<double, 4> kPitchesMm = {0.4, 0.2, 0.1, 0.05};
/// The pitch at which speeds are compared.
constexpr std::size_t kCompared = 2;
/// One row of the standard job, and the beginning of the next one.
constexpr std::size_t kMoves = 130;

/// CPU times per move of the repetitions, µs, sorted, and the volume removed.
struct Cost {
  std::vector<double> us;
  double removed_mm3 = 0;

  double best_us() const { return us.front(); }
  double median_us() const { return us[us.size() / 2]; }
};
using Costs = std::array<Cost, kPitchesMm.size()>;

std::vector<ToolPose> path_of(bool five_axis) {
  std::vector<ToolPose> path = standard_path(five_axis);
  path.resize(kMoves + 1);
  return path;
}

/// Runs a job, which moves between two poses and returns the removed volume, and adds its time.
template <class Job>
void run(Job job, const std::vector<ToolPose>& path, Cost& cost) {
  const double start = cpu_seconds();
  for (std::size_t i = 1; i < path.size(); ++i) job.move(path[i - 1], path[i]);
  cost.us.push_back((cpu_seconds() - start) * 1e6 / double(kMoves));
  std::ranges::sort(cost.us);
  cost.removed_mm3 = job.removed_mm3();
}

/// A sculpture that is carved by one tool.
struct KernelJob {
  Sculpture sculpture;

  void move(const ToolPose& from, const ToolPose& to) {
    sculpture.apply(MoveTool{1, from, to, 0.01}).value();
  }
  double removed_mm3() const { return sculpture.removed_volume_mm3(); }
};

KernelJob kernel_job(const Tool& tool, Rays rays, double pitch_mm, double tolerance_mm) {
  SculptureSettings settings = standard_settings(pitch_mm, tolerance_mm);
  settings.rays = rays;
  KernelJob job{*Sculpture::create(settings)};
  job.sculpture.apply(DefineTool{1, tool}).value();
  return job;
}

/// Returns the slope of the straight line through log(time) over log(1/pitch).
double growth(const Costs& costs) {
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t p = 0; p < costs.size(); ++p) {
    const double u = -std::log(kPitchesMm[p]), v = std::log(costs[p].best_us());
    x += u, y += v, xx += u * u, xy += u * v;
  }
  const auto n = double(costs.size());
  return (n * xy - x * y) / (n * xx - x * x);
}

void print_row(const std::string& tool, int axes, const char* kind, const Costs& costs,
               const std::string& compared) {
  std::printf("| %s | %d | %s |", tool.c_str(), axes, kind);
  for (const Cost& c : costs) {
    const int digits = c.best_us() < 10 ? 2 : c.best_us() < 100 ? 1 : 0;
    std::printf(" %.*f, %.*f |", digits, c.best_us(), digits, c.median_us());
  }
  std::printf(" %.2f | %s |\n", growth(costs), compared.c_str());
  std::fflush(stdout);
}

std::string share_text(const char* format, double share) {
  char text[64];
  std::snprintf(text, sizeof text, format, share);
  return text;
}

std::optional<BareTool> bare_tool(const std::string& name) {
  if (name == "ball") return BareTool::kBall;
  if (name == "flat") return BareTool::kFlat;
  if (name == "bull_nose") return BareTool::kBullNose;
  return std::nullopt;
}

/// The compared jobs alternate, because the speed of a machine varies.
void print_tool(const NamedTool& t, bool five_axis, double tolerance_mm, int repetitions) {
  const std::vector<ToolPose> path = path_of(five_axis);
  const auto bare = bare_tool(t.name);
  Costs one, limit, three;
  for (std::size_t p = 0; p < kPitchesMm.size(); ++p) {
    const double pitch_mm = kPitchesMm[p];
    for (int k = 0; k < repetitions; ++k) {
      run(kernel_job(t.tool, Rays::kDexel, pitch_mm, tolerance_mm), path, one[p]);
      if (bare) run(BareLoop(*bare, pitch_mm), path, limit[p]);
      run(kernel_job(t.tool, Rays::kTriDexel, pitch_mm, tolerance_mm), path, three[p]);
    }
  }
  const int axes = five_axis ? 5 : 3;
  const Cost& compared = one[kCompared];
  const double share = bare ? limit[kCompared].best_us() / compared.best_us() : 0;
  print_row(t.name, axes, "one field", one,
            bare ? share_text("%.2f of the bare loop", share) : std::string());
  if (bare) {
    const double volume = limit[kCompared].removed_mm3 / compared.removed_mm3;
    print_row(t.name, axes, "bare loop", limit, share_text("%.4f of the volume", volume));
  }
  print_row(t.name, axes, "three fields", three,
            share_text("%.1f times one field", three[kCompared].best_us() / compared.best_us()));
}

}  // namespace

void print_growth_table(double tolerance_mm, int repetitions) {
  std::printf("\nCPU time per move of %zu, us, best and median of %d; tolerance %g mm:\n\n", kMoves,
              repetitions, tolerance_mm);
  std::printf("| tool | axes | |");
  for (const double pitch : kPitchesMm) std::printf(" %g mm |", pitch);
  std::printf(" growth | at %g mm |\n|---|---|---|", kPitchesMm[kCompared]);
  for (std::size_t i = 0; i < kPitchesMm.size(); ++i) std::printf("---|");
  std::printf("---|---|\n");
  for (const NamedTool& t : every_tool()) {
    print_tool(t, false, tolerance_mm, repetitions);
    print_tool(t, true, tolerance_mm, repetitions);
  }
}

}  // namespace kerf::test
