// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/crossing_count.h"

#include <cstdio>

#include "tests/kernel/extremes/random_carving.h"
#include "tests/support/mesh_check.h"
#include "tests/support/self_intersection.h"
#include "tests/support/standard_job.h"

namespace kerf {
namespace {

constexpr unsigned kCarvings = 200;
constexpr double kColumns = 24;

void print(const char* name, Rays rays, const test::SelfIntersections& found) {
  std::printf(
      "%-20s %-9s %8zu triangles, %5zu pairs intersect (%5zu triangles), %4zu without area\n", name,
      to_string(rays), found.triangles, found.pairs, found.crossed, found.zero_area);
}

test::SelfIntersections of_standard_job(bool five_axis, Rays rays) {
  constexpr double kPitchMm = 0.5;
  SculptureSettings settings = test::standard_settings(kPitchMm, 0.01);
  settings.keep_normals = true;
  settings.rays = rays;
  auto sculpture = *Sculpture::create(settings);
  sculpture.apply(DefineTool{1, *make_tool(BallShape{10, 50})}).value();
  const std::vector<ToolPose> path = test::standard_path(five_axis);
  for (std::size_t n = 1; n < path.size(); ++n) {
    sculpture.apply(MoveTool{1, path[n - 1], path[n], 0.01, false}).value();
  }
  return test::count_self_intersections(test::mesh_all(sculpture.solid()), 2 * kPitchMm);
}

}  // namespace

void print_crossings() {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    print("three axes, 0.5 mm", rays, of_standard_job(false, rays));
    print("five axes, 0.5 mm", rays, of_standard_job(true, rays));
    test::SelfIntersections sum;
    unsigned carvings = 0;
    for (unsigned seed = 1; seed <= kCarvings; ++seed) {
      const double pitch_mm = std::array{1.0, 0.5, 0.25, 0.1}[seed % 4];
      test::RandomCarving carving(seed, kColumns * pitch_mm, pitch_mm, rays);
      const auto found =
          test::count_self_intersections(test::mesh_all(carving.sculpture.solid()), 2 * pitch_mm);
      sum.triangles += found.triangles;
      sum.pairs += found.pairs;
      sum.crossed += found.crossed;
      sum.zero_area += found.zero_area;
      carvings += found.pairs > 0 ? 1 : 0;
    }
    print("200 random carvings", rays, sum);
    std::printf("%-20s %-9s in %u of them\n", "", "", carvings);
  }
}

}  // namespace kerf
