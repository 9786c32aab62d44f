// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/crossing_count.h"

#include <array>
#include <cstdio>
#include <random>

#include "tests/kernel/extremes/random_carving.h"
#include "tests/support/mesh_check.h"
#include "tests/support/self_intersection.h"
#include "tests/support/standard_job.h"

namespace kerf {
namespace {

constexpr unsigned kCarvings = 200;
constexpr double kColumns = 24;
constexpr unsigned kSlotted = 4000;

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

/// A small block with slots along random directions in which all coordinates are multiples of a
/// quarter of the pitch, so that floors and walls coincide with samples and with each other.
Sculpture with_slots(unsigned seed, Rays rays) {
  std::mt19937 random(seed);
  const auto quarter = [&](unsigned most) { return 0.25 * double(random() % (4 * most + 1)); };
  auto sculpture =
      *Sculpture::create({.stock = BoxStock{{0, 0, 0}, {6, 6, 4}}, .rays = rays, .pitch_mm = 1});
  sculpture.apply(DefineTool{1, *make_tool(FlatShape{1.5, 9})}).value();
  constexpr std::array<Vec3, 6> kAxes{
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
  for (unsigned slots = 2 + unsigned(random() % 3); slots > 0; --slots) {
    const Vec3 axis = kAxes[random() % kAxes.size()];
    std::array<double, 6> at{};
    for (std::size_t n = 0; n < 6; ++n) at[n] = quarter(n % 3 == 2 ? 4 : 6);
    sculpture
        .apply(MoveTool{1, {{at[0], at[1], at[2]}, axis}, {{at[3], at[4], at[5]}, axis}, 1, false})
        .value();
  }
  return sculpture;
}

void add(const test::SelfIntersections& found, test::SelfIntersections& sum) {
  sum.triangles += found.triangles;
  sum.pairs += found.pairs;
  sum.crossed += found.crossed;
  sum.zero_area += found.zero_area;
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
      add(found, sum);
      carvings += found.pairs > 0 ? 1 : 0;
    }
    print("200 random carvings", rays, sum);
    std::printf("%-20s %-9s in %u of them\n", "", "", carvings);
    test::SelfIntersections slots;
    for (unsigned seed = 1; seed <= kSlotted; ++seed) {
      const auto meshes = test::mesh_all(with_slots(seed, rays).solid());
      add(test::count_self_intersections(meshes, 0.7), slots);
    }
    print("4000 slotted blocks", rays, slots);
  }
}

}  // namespace kerf
