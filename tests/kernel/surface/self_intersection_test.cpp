// SPDX-License-Identifier: Apache-2.0
// Surfaces do not intersect themselves and have no triangle without area, by exact predicates.

#include "tests/support/self_intersection.h"

#include "kernel/surface/quad_split.h"
#include "kernel/surface/solid_surface.h"
#include "tests/kernel/extremes/random_carving.h"
#include "tests/support/carvings.h"
#include "tests/support/exact_sign.h"
#include "tests/support/mesh_check.h"
#include "tests/support/standard_job.h"
#include "tests/support/test.h"

namespace kerf::self_intersection_test {
namespace {

using test::FloatTriangle;
using test::SelfIntersections;

void expect_none(const SelfIntersections& found) {
  EXPECT_EQ(found.pairs, 0U);
  EXPECT_EQ(found.zero_area, 0U);
}

TEST(ExactPredicates, DecideWhereDoublesCannot) {
  // One float step off a plane, which doubles cannot distinguish from a point on it.
  const float far = 16777216;
  const test::FloatPoint a{far, far, 0}, b{far + 2, far, 1e-30F}, c{far, far + 2, 1e-30F};
  EXPECT_EQ(test::orientation(a, b, c, {far + 2, far + 2, 2e-30F}), 0);
  EXPECT_NE(test::orientation(a, b, c, {far + 2, far + 2, 2.0000002e-30F}), 0);
  EXPECT_TRUE(test::are_collinear({0, 0, 0}, {1, 2, 3}, {2, 4, 6}));
  EXPECT_FALSE(test::are_collinear({0, 0, 0}, {1, 2, 3}, {2, 4, 6.0000005F}));
}

TEST(ExactPredicates, FindTrianglesThatMeetElsewhereThanInCommonCorners) {
  const FloatTriangle flat{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
  const auto meets = [&](const FloatTriangle& t) {
    EXPECT_EQ(test::do_intersect(flat, t), test::do_intersect(t, flat));
    return test::do_intersect(flat, t);
  };
  EXPECT_TRUE(meets({{{1, 1, -1}, {1, 1, 1}, {9, 9, 1}}}));      // pierced
  EXPECT_FALSE(meets({{{1, 1, 0.01F}, {1, 1, 1}, {9, 9, 1}}}));  // above
  EXPECT_TRUE(meets({{{1, 1, 0}, {1, 1, 1}, {9, 9, 1}}}));       // touched inside
  EXPECT_FALSE(meets({{{0, 0, 0}, {0, -1, 1}, {1, -1, 1}}}));    // a common corner
  EXPECT_TRUE(meets({{{0, 0, 0}, {1, 1, 1}, {1, 1, -1}}}));      // and pierced
  EXPECT_FALSE(meets({{{0, 0, 0}, {4, 0, 0}, {0, -4, 0}}}));     // a common edge, unfolded
  EXPECT_TRUE(meets({{{0, 0, 0}, {4, 0, 0}, {1, 1, 0}}}));       // folded back
  EXPECT_FALSE(meets({{{0, 0, 0}, {4, 0, 0}, {1, 1, 1}}}));
  EXPECT_TRUE(meets({{{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}}));  // inside, in one plane
  EXPECT_FALSE(meets({{{3, 3, 0}, {5, 3, 0}, {3, 5, 0}}}));
}

TEST(SplitWithinEnvelope, ChoosesTheDiagonalWithinTheEnvelope) {
  const std::array<Vec3, 4> plain{
      {{-0.5, -0.5, 0.5}, {0.5, -0.5, 0.5}, {0.5, 0.5, 0.5}, {-0.5, 0.5, 0.5}}};
  EXPECT_EQ(split_within_envelope(plain, true, QuadSplit::kFirst), QuadSplit::kFirst);
  EXPECT_EQ(split_within_envelope(plain, true, QuadSplit::kSecond), QuadSplit::kSecond);
  // Corner 0 is hollow: the diagonal between its neighbors passes beyond it.
  const std::array<Vec3, 4> hollow{
      {{-0.1, -0.1, 0.5}, {0.1, -0.9, 0.5}, {0.5, 0.5, 0.5}, {-0.9, 0.1, 0.5}}};
  EXPECT_EQ(split_within_envelope(hollow, true, QuadSplit::kSecond), QuadSplit::kFirst);
  // Both diagonals would pass the end of the edge.
  const std::array<Vec3, 4> saddle{
      {{-0.1, -0.1, 1}, {0.9, -0.1, 0}, {0.1, 0.1, 1}, {-0.9, 0.05, 0}}};
  EXPECT_EQ(split_within_envelope(saddle, false, QuadSplit::kFirst), QuadSplit::kFan);
}

TEST(SelfIntersection, RandomCarvingsHaveNone) {
  for (unsigned seed = 1; seed <= 50U * unsigned(test::effort()); ++seed) {
    const double pitch_mm = std::array{1.0, 0.5, 0.25, 0.1}[seed % 4];
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + " " + to_string(rays));
      test::RandomCarving carving(seed, 16 * pitch_mm, pitch_mm, rays);
      const auto meshes = test::mesh_all(carving.sculpture.solid());
      expect_none(test::count_self_intersections(meshes, 2 * pitch_mm));
    }
  }
}

/// Two slots of a flat tool, at quarters of the pitch, in a small block.
struct TwoSlots {
  Rays rays;
  struct {
    Vec3 axis, from, to;
  } slots[2];
};

void expect_sound(const TwoSlots& cut) {
  SCOPED_TRACE(to_string(cut.rays));
  auto sculpture = *Sculpture::create(
      {.stock = BoxStock{{0, 0, 0}, {6, 6, 4}}, .rays = cut.rays, .pitch_mm = 1});
  sculpture.apply(DefineTool{1, *make_tool(FlatShape{1.5, 9})}).value();
  for (const auto& [axis, from, to] : cut.slots) {
    sculpture.apply(MoveTool{1, {from, axis}, {to, axis}, 0.01, false}).value();
  }
  const auto meshes = test::mesh_all(sculpture.solid());
  EXPECT_EQ(test::check_mesh(meshes).open_edges, 0U);
  expect_none(test::count_self_intersections(meshes, 2));
}

/// At one corner of a flat quadrangle is a cell with several sheets, and the segment to the next
/// cell is bent.
TEST(SelfIntersection, FlatQuadranglesBendWithTheirNeighbors) {
  expect_sound({Rays::kDexel,
                {{{0, -1, 0}, {1.5, 0.25, 2.25}, {3.75, 3.5, 0.25}},
                 {{1, 0, 0}, {0.75, 3, 3}, {1.5, 4.5, 1}}}});
  expect_sound(
      {Rays::kTriDexel,
       {{{1, 0, 0}, {6, 6, 2.75}, {5, 3, 2.75}}, {{0, 0, -1}, {5, 6, 1.75}, {2.75, 5.25, 2.75}}}});
}

/// A fan about a vertex on an edge in the plane of a floor would be in that floor.
TEST(SelfIntersection, FansNextToFloorsAtSampleHeightStayOffThem) {
  expect_sound({Rays::kDexel,
                {{{0, 0, -1}, {3.25, 4, 3.5}, {1.75, 4, 1.5}},
                 {{0, 0, -1}, {3.5, 4, 1.75}, {4, 3.5, 0.5}}}});
  expect_sound({Rays::kTriDexel,
                {{{1, 0, 0}, {2.5, 0.5, 3.25}, {0.75, 1.5, 3.25}},
                 {{-1, 0, 0}, {1.5, 4.75, 1.25}, {4.25, 5, 4}}}});
}

TEST(SelfIntersection, StandardJobsHaveNone) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    for (const bool five_axis : {false, true}) {
      SculptureSettings settings = test::standard_settings(2, 0.01);
      settings.keep_normals = true;
      settings.rays = rays;
      auto sculpture = *Sculpture::create(settings);
      sculpture.apply(DefineTool{1, *make_tool(BallShape{10, 50})}).value();
      const std::vector<ToolPose> path = test::standard_path(five_axis);
      for (std::size_t n = 1; n < path.size(); ++n) {
        sculpture.apply(MoveTool{1, path[n - 1], path[n], 0.01, false}).value();
      }
      expect_none(test::count_self_intersections(test::mesh_all(sculpture.solid()), 4));
    }
  }
}

TEST(SelfIntersection, ExportsHaveNone) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    for (unsigned seed = 1; seed <= 2; ++seed) {
      auto sculpture = *Sculpture::create(
          {.stock = BoxStock{{0, 0, 0}, {90, 70, 12}}, .rays = rays, .pitch_mm = 0.5});
      test::RandomCarver carver(sculpture, {-2, 10, 5}, {12, 30, 13}, seed);
      for (int n = 0; n < 4; ++n) carver.cut();
      SolidSurface surface(sculpture.solid());
      std::vector<TileMesh> pieces;
      for (TileMesh piece; surface.next(piece);) pieces.push_back(piece);
      expect_none(test::count_self_intersections(pieces, 2));
    }
  }
}

}  // namespace
}  // namespace kerf::self_intersection_test
