// SPDX-License-Identifier: Apache-2.0
// Measures the speed-up by several threads on long and short blocks of NC programs. Short ones are
// applied 64 at a time, as by kerf-carve. The thread counts are interleaved on separate stocks, so
// that other load affects all of them alike. The least time of each motion over all rounds counts.
// All results must be byte-identical. Usage: threads_bench [threads=cores] [turns=7] [pitch_mm=0.1]
// [part of a job's name]

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "server/threads/thread_pool.h"
#include "tests/support/standard_job.h"

namespace {

using namespace kerf;

constexpr double kNever = 1e300;

struct Job {
  std::string name;
  ToolShape shape;
  Rays rays = Rays::kDexel;
  std::vector<ToolPose> path;
  std::size_t together = 1;  ///< motions that are applied at a time
};

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Returns a raster of long blocks, rows `step_mm` apart, 5 mm deep. Odd rows lean to the opposite
/// side, so that the axis turns by twice `lean_rad` along each block.
std::vector<ToolPose> raster(int rows, double step_mm, double lean_rad, double aside) {
  std::vector<ToolPose> path;
  for (int row = 0; row < rows; ++row) {
    const bool forward = row % 2 == 0;
    const auto pose = [&](double x, double lean) {
      return ToolPose{{x, 4 + step_mm * row + aside * x, 45}, {std::sin(lean), 0, std::cos(lean)}};
    };
    path.push_back(pose(forward ? 3 : 97, forward ? -lean_rad : lean_rad));
    path.push_back(pose(forward ? 97 : 3, forward ? lean_rad : -lean_rad));
  }
  return path;
}

bool is_same(const MotionResult& a, const MotionResult& b) {
  return a.removed_mm3 == b.removed_mm3 && a.wrench.force_n == b.wrench.force_n &&
         a.changed_tiles == b.changed_tiles;
}

/// Prints the least seconds of each motion over the rounds, for each thread count.
void compare(const Job& job, double pitch_mm, int threads, int turns) {
  std::vector<int> counts;
  for (int n = 1; n < threads; n *= 2) counts.push_back(n);
  counts.push_back(threads);
  std::vector<std::unique_ptr<ThreadPool>> pools;
  for (const int n : counts) pools.push_back(std::make_unique<ThreadPool>(n));
  std::vector<std::vector<double>> least(counts.size(),
                                         std::vector<double>(job.path.size(), kNever));
  bool same = true;
  for (int turn = 0; turn < turns; ++turn) {
    std::vector<Sculpture> blocks;
    SculptureSettings settings = test::standard_settings(pitch_mm, 0.005);
    settings.rays = job.rays;
    for (std::size_t k = 0; k < counts.size(); ++k) {
      blocks.push_back(*Sculpture::create(settings));
      blocks.back().apply(DefineTool{1, *make_tool(job.shape)}).value();
    }
    for (std::size_t i = 1; i < job.path.size(); i += job.together) {
      std::vector<MoveTool> moves;
      for (std::size_t m = i; m < std::min(i + job.together, job.path.size()); ++m) {
        moves.push_back({1, job.path[m - 1], job.path[m], 1});
      }
      std::vector<MotionResult> first;
      for (std::size_t k = 0; k < counts.size(); ++k) {
        const double start = seconds_now();
        std::vector<MotionResult> results = blocks[k].apply(moves, *pools[k]);
        least[k][i] = std::min(least[k][i], seconds_now() - start);
        if (k == 0) first = std::move(results);
        if (k > 0) same &= std::ranges::equal(first, results, is_same);
      }
    }
    for (Sculpture& s : blocks) same &= s.state_hash() == blocks.front().state_hash();
  }
  std::printf("%-40s", job.name.c_str());
  double one = 0;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    double sum = 0;
    for (const double seconds : least[k]) sum += seconds < kNever ? seconds : 0;
    const double us = 1e6 * sum / double(job.path.size() - 1);
    if (k == 0) one = us;
    std::printf("  %d: %9.1f us, x %.2f", counts[k], us, one / us);
  }
  std::printf("  %s\n", same ? "same bytes" : "BYTES DIFFER");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int threads = argc > 1 ? std::max(2, std::atoi(argv[1])) : std::max(2, usable_threads());
  const int turns = argc > 2 ? std::max(1, std::atoi(argv[2])) : 7;
  const double pitch_mm = argc > 3 ? std::atof(argv[3]) : 0.1;
  const std::string only = argc > 4 ? argv[4] : "";
  std::printf("wall time per motion by number of threads, and gain; pitch %.3g mm\n", pitch_mm);
  const ToolShape ball = BallShape{10, 50}, flat = FlatShape{10, 50};
  std::vector<ToolPose> moves = test::standard_path(false), swings = test::standard_path(true);
  moves.resize(1000);
  swings.resize(500);
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    const std::string fields = rays == Rays::kDexel ? "1 field: " : "3 fields: ";
    for (const Job& job : std::vector<Job>{
             {fields + "100 mm, ball", ball, rays, raster(8, 3, 0, 0)},
             {fields + "100 mm aslant, ball", ball, rays, raster(8, 3, 0, 0.7)},
             {fields + "100 mm, flat", flat, rays, raster(8, 7, 0, 0)},
             {fields + "100 mm turning 20 deg, ball", ball, rays, raster(8, 3, 0.1745, 0)},
             {fields + "100 mm turning 20 deg, flat", flat, rays, raster(8, 7, 0.1745, 0)},
             {fields + "1 mm, ball", ball, rays, moves, 64},
             {fields + "1 mm swinging, ball", ball, rays, swings, 64},
             {fields + "1 mm swinging, flat", flat, rays, swings, 64}}) {
      if (job.name.find(only) != std::string::npos) compare(job, pitch_mm, threads, turns);
    }
  }
  return 0;
}
