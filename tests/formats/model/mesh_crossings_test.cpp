// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/mesh_crossings.h"

#include "server/formats/model/triangle_pair.h"
#include "tests/support/exact_sign.h"
#include "tests/support/test.h"

namespace kerf::mesh_crossings_test {
namespace {

/// Small integers, so that corners coincide and touch sides and planes. Some triangles are moved by
/// one last bit, or have such different sizes that differences are inexact.
FloatTriangle random_triangle(std::mt19937& random) {
  FloatTriangle t;
  for (auto& corner : t) {
    for (float& c : corner) {
      c = static_cast<float>(random() % 4);
      if (random() % 16 == 0) c = std::nextafter(c, random() % 2 == 0 ? -9.0F : 9.0F);
      if (random() % 64 == 0) c = std::ldexp(1.0F, -static_cast<int>(random() % 120));
    }
  }
  return t;
}

TEST(TrianglePair, AgreesWithIntegersOfAnySize) {
  std::mt19937 random(1);
  int crossings = 0, touching_nothing = 0, without_area = 0;
  for (int n = 0; n < 40000; ++n) {
    const FloatTriangle s = random_triangle(random), t = random_triangle(random);
    const bool flat = test::are_collinear(s[0], s[1], s[2]);
    ASSERT_EQ(has_no_area(s), flat);
    without_area += flat ? 1 : 0;
    if (flat || has_no_area(t)) continue;
    const bool crosses = test::do_intersect(s, t);
    ASSERT_EQ(do_cross(s, t), crosses) << n;
    ASSERT_EQ(do_cross(t, s), crosses) << n;
    (crosses ? crossings : touching_nothing) += 1;
  }
  EXPECT_GT(crossings, 1000);
  EXPECT_GT(touching_nothing, 1000);
  EXPECT_GT(without_area, 100);
}

TEST(CrossingTriangles, IntersectOutsideCommonCorners) {
  IndexedMesh mesh;
  // A row of separate triangles, one pierced by the next but one, and one with zero area.
  for (std::uint32_t n = 0; n < 200; ++n) {
    const float x = 3 * static_cast<float>(n);
    for (const auto& p : {std::array{x, 0.0F, 0.0F}, {x + 2, 0.0F, 0.0F}, {x, 2.0F, 0.0F}}) {
      mesh.positions_mm.push_back(p);
    }
    mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  EXPECT_TRUE(crossing_triangles(mesh).empty());
  mesh.positions_mm[3 * 120] = {3 * 118 + 0.5F, 0.5F, -1};
  mesh.positions_mm[3 * 120 + 1] = {3 * 118 + 0.5F, 0.5F, 1};
  mesh.positions_mm[3 * 7 + 2] = {3 * 7 + 1, 0, 0};
  // Triangle 120 also intersects the one between.
  EXPECT_EQ(crossing_triangles(mesh), (std::vector<std::uint32_t>{7, 118, 119, 120}));
  EXPECT_TRUE(crossing_triangles({}).empty());
}

}  // namespace
}  // namespace kerf::mesh_crossings_test
