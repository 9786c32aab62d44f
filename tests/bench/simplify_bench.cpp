// SPDX-License-Identifier: Apache-2.0
// Measures the cost of simplifying a model relative to writing it, by CPU time of one thread, best
// of N: three surfaces, to an error and to a number of triangles. Usage: simplify_bench [N=3]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "kernel/sculpture.h"
#include "server/formats/model/model_writer.h"
#include "server/formats/model/simplify_mesh.h"
#include "tests/bench/cpu_clock.h"
#include "tests/support/carvings.h"

namespace {

using namespace kerf;

/// Rows of grooves of a ball of 10 mm, 1.5 mm apart, in a block of 100 mm. Each motion is deeper or
/// less deep by up to `rough_mm`, at random.
SolidSnapshot grooves(double pitch_mm, double wave_mm, double rough_mm) {
  Sculpture sculpture = test::make_sculpture(BoxStock{{0, 0, -30}, {100, 100, 0}}, pitch_mm);
  if (!sculpture.apply(DefineTool{1, *make_tool(BallShape{10, 40})})) std::exit(1);
  std::uint32_t random = 1;
  for (double y = 2; y < 98; y += 1.5)
    for (int x = 2; x < 98; ++x) {
      random = random * 1664525 + 1013904223;
      const double off = rough_mm * (double(random >> 8) / 8388608 - 1);
      const auto depth = [&](int at) {
        return off - 5 - wave_mm * std::sin(at / 9.0) * std::cos(y / 11);
      };
      const MoveTool move{1, {{double(x), y, depth(x)}}, {{x + 1.0, y, depth(x + 1)}}, 0.1};
      if (!sculpture.apply(move)) std::exit(1);
    }
  return sculpture.solid();
}

template <class Step>
double best_of(int repetitions, const Step& step) {
  double best = std::numeric_limits<double>::infinity();
  for (int n = 0; n < repetitions; ++n) {
    const double start = test::cpu_seconds();
    step();
    best = std::min(best, test::cpu_seconds() - start);
  }
  return best;
}

void measure(const char* name, const SolidSnapshot& solid, int repetitions) {
  const auto file = std::filesystem::temp_directory_path() / "kerf_simplify_bench.stl";
  std::uint64_t all = 0;
  const double writing = best_of(repetitions, [&] {
    SnapshotMesh source(solid);
    const auto written = write_model(file, source, {});
    if (!written) std::exit(1);
    all = written->triangles;
  });
  std::filesystem::remove(file);
  std::printf("%s: %llu triangles, written as STL in %.2f s\n", name,
              static_cast<unsigned long long>(all), writing);
  for (const SimplifyRequest& request :
       {SimplifyRequest{{}, 0.2}, {{}, 0.05}, {{}, 0.01}, {{}, 0.002}, {50'000, {}}, {5'000, {}}}) {
    SimplifiedMesh found;
    const double seconds = best_of(repetitions, [&] {
      SnapshotMesh source(solid);
      auto simplified = simplify_mesh(source, request);
      if (!simplified) std::exit(1);
      found = *std::move(simplified);
    });
    if (request.error_mm) {
      std::printf("  within %5.3f mm     ", *request.error_mm);
    } else {
      std::printf("  %6llu triangles    ", static_cast<unsigned long long>(*request.triangles));
    }
    std::printf("%7zu triangles, %.4f mm, %zu cross, %5.2f s, %4.1f times writing\n",
                found.mesh.triangles.size(), found.error_mm, found.crossing_triangles, seconds,
                seconds / writing);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int repetitions = argc > 1 ? std::atoi(argv[1]) : 3;
  if (repetitions < 1) {
    std::fprintf(stderr, "usage: simplify_bench [repetitions >= 1]\n");
    return 2;
  }
  measure("waves, 0.2 mm", grooves(0.2, 3, 0), repetitions);
  measure("level grooves, 0.2 mm", grooves(0.2, 0, 0), repetitions);
  measure("rough, 0.4 mm", grooves(0.4, 3, 0.2), repetitions);
}
