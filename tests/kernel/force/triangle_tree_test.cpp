// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/triangle_tree.h"

#include "kernel/math/nearest_on_triangle.h"
#include "tests/support/test.h"

namespace kerf::triangle_tree_test {
namespace {

using Triangles = std::vector<TriangleTree::Triangle>;

/// Visits all triangles.
TriangleTree::Found visit_all(const Triangles& triangles, Vec3 p) {
  TriangleTree::Found found;
  double least = 1e300;
  for (std::uint32_t n = 0; n < triangles.size(); ++n) {
    const Vec3 to = p - nearest_on_triangle(triangles[n], p).point;
    if (dot(to, to) < least) {
      least = dot(to, to);
      found.nearest = n;
    }
    found.inside ^= crosses_upward(triangles[n], p);
  }
  return found;
}

/// A ball of split quadrilaterals. The triangles at the poles have no area. On whole mm many points
/// have several nearest triangles.
Triangles ball(int rings, Vec3 center, double radius_mm, bool whole_mm) {
  Triangles all;
  const auto at = [&](int ring, int step) {
    const double low = std::numbers::pi * ring / rings, turn = std::numbers::pi * step / rings;
    Vec3 p = center + radius_mm * Vec3{std::sin(low) * std::cos(turn),
                                       std::sin(low) * std::sin(turn), -std::cos(low)};
    if (whole_mm) p = {std::round(p.x), std::round(p.y), std::round(p.z)};
    return p;
  };
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < 2 * rings; ++s) {
      all.push_back({at(r, s), at(r, s + 1), at(r + 1, s + 1)});
      all.push_back({at(r, s), at(r + 1, s + 1), at(r + 1, s)});
    }
  }
  return all;
}

TEST(TriangleTree, MatchesAVisitOfAllTriangles) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int n = 0; n < 48; ++n) {
    const double far_mm = n % 3 == 0 ? 0 : n % 3 == 1 ? 1000 : 1e5;
    const Vec3 center{far_mm, -far_mm, 0};
    const Triangles triangles = ball(3 + n % 12, center, 20, n % 2 == 0);
    const TriangleTree tree(triangles);
    for (int q = 0; q < 1000; ++q) {
      Vec3 p = center + 30 * Vec3{unit(random), unit(random), unit(random)};
      if (q % 3 == 0) p = {std::round(p.x), std::round(p.y), std::round(p.z)};
      if (q % 7 == 0) p = triangles[random() % triangles.size()][random() % 3];
      const auto expected = visit_all(triangles, p), found = tree.find(p);
      ASSERT_EQ(found.nearest, expected.nearest) << n << ' ' << q;
      ASSERT_EQ(found.inside, expected.inside) << n << ' ' << q;
    }
  }
}

TEST(TriangleTree, AcceptsTrianglesThatNoPlaneDivides) {
  // Triangles on top of each other, and a long row whose halves are always uneven.
  Triangles triangles(300, {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}});
  for (int n = 0; n < 300; ++n) {
    const double x = std::ldexp(1.0, n % 60);
    triangles.push_back({Vec3{x, 0, 0}, Vec3{x, 1, 0}, Vec3{x, 0, 1}});
  }
  const TriangleTree tree(triangles);
  std::mt19937 random(2);
  for (int q = 0; q < 1000; ++q) {
    const Vec3 p{std::ldexp(1.1, int(random() % 60)), 0.3, -0.2};
    ASSERT_EQ(tree.find(p).nearest, visit_all(triangles, p).nearest);
  }
}

TEST(TriangleTree, VisitsFewOfManyTriangles) {
  // 200,000 triangles; visits of all of them would take minutes.
  const Triangles triangles = ball(224, {}, 50, false);
  EXPECT_GT(triangles.size(), 200'000U);
  const TriangleTree tree(triangles);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int q = 0; q < 20'000; ++q) {
    const Vec3 p = 60 * Vec3{unit(random), unit(random), unit(random)};
    const double from_surface = length(p) - 50;
    // The chords are up to 0.005 mm inside the ball.
    if (std::abs(from_surface) < 0.02) continue;
    EXPECT_EQ(tree.find(p).inside, from_surface < 0);
  }
}

}  // namespace
}  // namespace kerf::triangle_tree_test
