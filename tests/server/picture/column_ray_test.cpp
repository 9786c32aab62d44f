// SPDX-License-Identifier: Apache-2.0
// Rays through carved blocks, against analytic surfaces and against marching in small steps.
#include "server/picture/column_ray.h"

#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::column_ray_test {
namespace {

Sculpture block_of(const StockShape& stock, double pitch_mm) {
  return *Sculpture::create({.stock = stock, .pitch_mm = pitch_mm, .tolerance_mm = 0.001});
}

void carve(Sculpture& block, const ToolShape& shape, Vec3 from, Vec3 to) {
  block.apply(DefineTool{1, *make_tool(shape)}).value();
  block.apply(MoveTool{1, {from, {0, 0, 1}}, {to, {0, 0, 1}}, 0, false}).value();
}

bool is_solid(const DexelSnapshot& field, Vec3 at) {
  const DexelGrid& grid = field.grid();
  const Vec3 in = at - grid.origin_mm;
  const auto i = static_cast<std::int32_t>(std::floor(in.x / grid.pitch_mm));
  const auto j = static_cast<std::int32_t>(std::floor(in.y / grid.pitch_mm));
  std::vector<Dexel> scratch;
  for (const Dexel& element : field.column(i, j, scratch)) {
    const double depth = in.z / grid.z_quantum_mm;
    if (depth >= element.bottom && depth <= element.top) return true;
  }
  return false;
}

constexpr BoxStock kBox{{0, 0, 0}, {20, 20, 10}};

TEST(ColumnRay, MeetsTheGrooveOfABallOnItsCylinder) {
  auto block = block_of(kBox, 0.1);
  carve(block, BallShape{8, 40}, {-10, 10, 7}, {30, 10, 7});  // its axis runs at z = 11
  const DexelSnapshot field = block.snapshot();
  for (double y = 6.6; y < 13.5; y += 0.37) {
    for (const double lean : {-0.4, 0.0, 0.4}) {
      const Vec3 towards = normalized({lean, 0, -1});
      const auto hit = first_hit(field, Vec3{10, y, 30} - towards * 5, towards);
      ASSERT_TRUE(hit) << y;
      const Vec3 out = normalized({0, 10 - hit->point_mm.y, 11 - hit->point_mm.z});
      const double radius = std::hypot(10 - hit->point_mm.y, 11 - hit->point_mm.z);
      // A column has the depth at its center: the surface is off by its slope times half a pitch.
      EXPECT_NEAR(radius, 4, 0.05 * std::abs(out.y) + 0.002) << y;
      EXPECT_GT(dot(hit->normal, out), std::cos(0.04)) << y;
      EXPECT_TRUE(hit->is_cut) << y;
    }
  }
}

TEST(ColumnRay, ASlopeSeenFromTheSideHasTheSlopesNormal) {
  auto block = block_of(kBox, 0.1);
  carve(block, BallShape{8, 40}, {-10, 10, 7}, {30, 10, 7});
  const Vec3 towards = normalized({0, 1, -0.5});  // meets the far flank, mostly through sides
  int hits = 0;
  for (double x = 5; x < 15; x += 0.077) {
    const Vec3 on_flank{x, 10 + 4 * std::sin(0.9), 11 - 4 * std::cos(0.9)};
    const auto hit = first_hit(block.snapshot(), on_flank - towards * 3, towards);
    ASSERT_TRUE(hit) << x;
    const Vec3 out = normalized({0, 10 - hit->point_mm.y, 11 - hit->point_mm.z});
    EXPECT_GT(dot(hit->normal, out), std::cos(0.06)) << x;
    EXPECT_TRUE(hit->is_cut);
    ++hits;
  }
  EXPECT_GT(hits, 100);
}

TEST(ColumnRay, OriginalSurfacesOfAMeshAreNotCut) {
  TriangleMesh mesh;  // |x| + |y| + |z| <= 10
  mesh.vertices_mm = {{10, 0, 0}, {0, 10, 0}, {0, 0, 10}, {-10, 0, 0}, {0, -10, 0}, {0, 0, -10}};
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2},
                    {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
  SculptureSettings settings;
  settings.stock_mesh = std::make_shared<const TriangleMesh>(mesh);
  settings.pitch_mm = 0.1;
  Sculpture block = *Sculpture::create(settings);
  carve(block, BallShape{4, 40}, {-20, 0, 4}, {20, 0, 4});  // its axis runs at z = 6
  const DexelSnapshot field = block.snapshot();
  const auto meet = [&](Vec3 at, Vec3 towards) {
    return first_hit(field, at - towards * 30, towards);
  };
  for (const double lean : {-0.5, 0.0, 0.5}) {
    const Vec3 down = normalized({lean, 0, -1});
    const auto groove = meet({0, 0.3, 4}, down), flank = meet({1, 4, 5}, down);
    ASSERT_TRUE(groove && flank);
    EXPECT_TRUE(groove->is_cut) << lean;
    EXPECT_FALSE(flank->is_cut) << lean;
  }
  for (const double z : {-4.03, -1.01, 1.03}) {
    const auto side = meet({9, 0.05, z}, {-1, 0, 0});
    ASSERT_TRUE(side) << z;
    EXPECT_FALSE(side->is_cut) << z;
  }
}

TEST(ColumnRay, OriginalSurfacesAreNotCut) {
  const CylinderStock cylinder{10, 10, 8, 0, 10};
  auto block = block_of(cylinder, 0.1);
  carve(block, FlatShape{2, 40}, {10, 10, 6}, {10, 10, 6});
  const DexelSnapshot field = block.snapshot();
  for (int n = 0; n < 40; ++n) {
    const double angle = 0.157 * n;
    const Vec3 radial{std::cos(angle), std::sin(angle), 0};
    const auto side =
        first_hit(field, Vec3{10, 10, 8} + radial * 20, normalized(-radial - Vec3{0, 0, 0.1}));
    ASSERT_TRUE(side) << n;
    EXPECT_FALSE(side->is_cut) << n;
    EXPECT_GT(dot(side->normal, radial), std::cos(0.35)) << n;
    const auto top = first_hit(field, Vec3{10, 10, 20} + radial * 5, {0, 0, -1});
    ASSERT_TRUE(top) << n;
    EXPECT_FALSE(top->is_cut) << n;
    EXPECT_EQ(top->normal, (Vec3{0, 0, 1})) << n;
  }
  const auto pocket = test::value_of(first_hit(field, {10, 10, 20}, {0, 0, -1}));
  EXPECT_TRUE(pocket.is_cut);
  EXPECT_NEAR(pocket.point_mm.z, 6, 0.002);
}

TEST(ColumnRay, PassesThroughAHoleAndMeetsItsWall) {
  auto block = block_of(kBox, 0.1);
  carve(block, FlatShape{6, 40}, {10, 10, 20}, {10, 10, -1});
  const DexelSnapshot field = block.snapshot();
  EXPECT_FALSE(first_hit(field, {10, 10, 30}, {0, 0, -1}));
  EXPECT_FALSE(first_hit(field, {9, 11, -5}, {0, 0, 1})) << "from below";
  EXPECT_FALSE(meets_stock(field, {10, 8, 30}, normalized({0, 0.1, -1})));
  const auto wall = test::value_of(first_hit(field, {10, 10, 30}, normalized({0.12, 0, -1})));
  EXPECT_NEAR(wall.point_mm.x, 13, 0.1);
  EXPECT_NEAR(wall.point_mm.z, 5, 1);
  EXPECT_TRUE(wall.is_cut);
  EXPECT_LT(wall.normal.x, -0.9) << "towards the axis of the hole";
  const auto underside = test::value_of(first_hit(field, {5, 5, -5}, {0, 0, 1}));
  EXPECT_EQ(underside.normal, (Vec3{0, 0, -1}));
  EXPECT_FALSE(underside.is_cut);
}

TEST(ColumnRay, MissesTheBlock) {
  auto block = block_of(kBox, 0.5);
  const DexelSnapshot field = block.snapshot();
  EXPECT_FALSE(first_hit(field, {10, 10, 30}, {0, 0, 1})) << "behind the eye";
  EXPECT_FALSE(first_hit(field, {10, -5, 11}, {0, 1, 0})) << "above";
  EXPECT_FALSE(first_hit(field, {-1, 10, 30}, {0, 0, -1})) << "beside";
  EXPECT_TRUE(first_hit(field, {10, -5, 9}, {0, 1, 0}));
}

/// Asserts that a ray is free up to its hit and inside the stock right behind. Returns the hit.
std::optional<RayHit> compare_with_marching(const DexelSnapshot& field, Vec3 from, Vec3 towards) {
  constexpr double kStep = 0.01, kEnd = 60, kNear = 1e-6;
  const auto hit = first_hit(field, from, towards);
  EXPECT_EQ(hit.has_value(), meets_stock(field, from, towards));
  const double free = hit ? dot(hit->point_mm - from, towards) : kEnd;
  double t = 0;
  while (t < free - kNear && !is_solid(field, from + towards * t)) t += kStep;
  EXPECT_GE(t, free - kNear) << "there is stock before the hit";
  EXPECT_TRUE(!hit || is_solid(field, from + towards * (free + kNear)));
  return hit;
}

TEST(ColumnRay, AgreesWithMarchingInSmallSteps) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> at(0, 20), height(-2, 9), angle(0, 6.283), rise(-0.9, 0.9);
  int hits = 0, facing_away = 0;
  for (const StockShape& stock : {StockShape(kBox), StockShape(CylinderStock{10, 10, 9, 0, 10})}) {
    auto block = block_of(stock, 0.4);
    for (int n = 0; n < 12; ++n) {
      carve(block, BallShape{3, 6}, {at(random), at(random), height(random)},
            {at(random), at(random), height(random)});
    }
    const DexelSnapshot field = block.snapshot();
    for (int n = 0; n < 400 && !HasFailure(); ++n) {
      const double turn = angle(random), z = rise(random), flat = std::sqrt(1 - z * z);
      const Vec3 towards{flat * std::cos(turn), flat * std::sin(turn), z};
      const Vec3 aim{at(random), at(random), 0.5 * at(random)};
      const auto hit = compare_with_marching(field, aim - towards * 30, towards);
      if (!hit) continue;
      EXPECT_NEAR(length(hit->normal), 1, 1e-5);
      ++hits;
      facing_away += dot(hit->normal, towards) > 0.1;
    }
  }
  EXPECT_GT(hits, 500);
  // Tops of columns on a slope that faces away stick out of its silhouette.
  EXPECT_LT(facing_away, hits / 50);
}

}  // namespace
}  // namespace kerf::column_ray_test
