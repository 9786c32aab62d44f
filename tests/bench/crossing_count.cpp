// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/crossing_count.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "tests/kernel/extremes/random_carving.h"
#include "tests/support/mesh_check.h"

namespace kerf {
namespace {

constexpr unsigned kCarvings = 200;
constexpr double kColumns = 24;
// Relative to the edge and to the triangle's height: an edge that only touches does not cross.
constexpr double kTouch = 1e-4;

struct Triangle {
  std::array<Vec3, 3> p;
  Vec3 low, high;
};

Vec3 least(Vec3 a, Vec3 b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
Vec3 most(Vec3 a, Vec3 b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

std::vector<Triangle> triangles_of(const SolidSnapshot& solid) {
  std::vector<Triangle> all;
  for (const TileMesh& mesh : test::mesh_all(solid)) {
    for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3) {
      Triangle t;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto& q = mesh.positions_mm[mesh.indices[n + c]];
        t.p[c] = {double(q[0]), double(q[1]), double(q[2])};
      }
      t.low = least(least(t.p[0], t.p[1]), t.p[2]);
      t.high = most(most(t.p[0], t.p[1]), t.p[2]);
      all.push_back(t);
    }
  }
  return all;
}

// Returns true if the segment passes through the interior of the triangle (Möller and Trumbore).
bool pierces(Vec3 from, Vec3 to, const Triangle& t) {
  const Vec3 edge = to - from, u = t.p[1] - t.p[0], v = t.p[2] - t.p[0];
  const Vec3 h = cross(edge, v);
  const double determinant = dot(u, h);
  if (std::abs(determinant) < 1e-9 * length(edge) * length(u) * length(v)) return false;
  const Vec3 s = from - t.p[0], q = cross(s, u);
  const double a = dot(s, h) / determinant, b = dot(edge, q) / determinant;
  const double share = dot(v, q) / determinant;
  return a > kTouch && b > kTouch && a + b < 1 - kTouch && share > kTouch && share < 1 - kTouch;
}

bool cross_each_other(const Triangle& a, const Triangle& b) {
  for (const Vec3& p : a.p)
    if (std::ranges::count(b.p, p) > 0) return false;
  for (std::size_t c = 0; c < 3; ++c) {
    if (pierces(a.p[c], a.p[(c + 1) % 3], b)) return true;
    if (pierces(b.p[c], b.p[(c + 1) % 3], a)) return true;
  }
  return false;
}

// Sorted along x; triangles with overlapping extents are tested.
std::size_t crossings(std::vector<Triangle> all) {
  std::ranges::sort(all, {}, [](const Triangle& t) { return t.low.x; });
  std::vector<bool> crossed(all.size());
  for (std::size_t n = 0; n < all.size(); ++n) {
    const Triangle& a = all[n];
    for (std::size_t m = n + 1; m < all.size() && all[m].low.x <= a.high.x; ++m) {
      const Triangle& b = all[m];
      if (b.low.y > a.high.y || a.low.y > b.high.y || b.low.z > a.high.z || a.low.z > b.high.z ||
          !cross_each_other(a, b))
        continue;
      crossed[n] = crossed[m] = true;
    }
  }
  return static_cast<std::size_t>(std::ranges::count(crossed, true));
}

}  // namespace

void print_crossings() {
  constexpr double kPitchMm = 1;
  std::printf("%u random five-axis carvings of %.0f columns\n", kCarvings, kColumns);
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    std::size_t triangles = 0, crossed = 0, carvings = 0;
    for (unsigned seed = 1; seed <= kCarvings; ++seed) {
      test::RandomCarving carving(seed, kColumns * kPitchMm, kPitchMm, rays);
      std::vector<Triangle> all = triangles_of(carving.sculpture.solid());
      triangles += all.size();
      const std::size_t found = crossings(std::move(all));
      crossed += found;
      carvings += found > 0 ? 1 : 0;
    }
    std::printf("%-9s %zu of %zu triangles cross another, in %zu carvings\n", to_string(rays),
                crossed, triangles, carvings);
  }
}

}  // namespace kerf
