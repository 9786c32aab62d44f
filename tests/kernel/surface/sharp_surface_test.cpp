// SPDX-License-Identifier: Apache-2.0
#include "tests/support/mesh_check.h"
#include "tests/support/standard_job.h"
#include "tests/support/test.h"

namespace kerf::sharp_surface_test {
namespace {

Sculpture sculpture_of(const StockShape& stock, double pitch_mm, Rays rays) {
  return *Sculpture::create({.stock = stock, .rays = rays, .pitch_mm = pitch_mm});
}

/// Calls visit(position in the scene, normal) for every vertex.
template <class Visit>
void for_vertices(Sculpture& sculpture, const Visit& visit) {
  const SolidSnapshot solid = sculpture.solid();
  for (const TileMesh& mesh : test::mesh_all(solid)) {
    for (std::size_t v = 0; v < mesh.positions_mm.size(); ++v) {
      const auto &p = mesh.positions_mm[v], &n = mesh.normals[v];
      visit(Vec3{double(p[0]), double(p[1]), double(p[2])} + solid.grid().origin_mm,
            Vec3{double(n[0]), double(n[1]), double(n[2])});
    }
  }
}

/// Three passes of a ball leave two ridges, at arbitrary positions between the columns.
Sculpture ridges(double pitch_mm, Rays rays) {
  Sculpture s = sculpture_of(BoxStock{{0, 0, 0}, {12, 10, 8}}, pitch_mm, rays);
  EXPECT_TRUE(s.apply(DefineTool{1, *make_tool(BallShape{10, 50})}));
  for (const double y : {3.1371, 5.1371, 7.1371}) {
    EXPECT_TRUE(s.apply(MoveTool{1, {{-6, y, 6}}, {{18, y, 6}}, 1, false}));
  }
  return s;
}

TEST(SharpSurface, RidgesBetweenPassesAreSharpToAHundredthOfThePitch) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    for (const double pitch : {0.5, 0.25, 0.1}) {
      Sculpture s = ridges(pitch, rays);
      double worst = 0;
      int on_ridge = 0;
      for_vertices(s, [&](Vec3 p, Vec3 normal) {
        if (p.y < 2.5 || p.y > 7.7 || p.z < 5 || p.x < 0.6 || p.x > 11.4) return;
        const double d =
            std::min({std::abs(p.y - 3.1371), std::abs(p.y - 5.1371), std::abs(p.y - 7.1371)});
        worst = std::max(worst, std::abs(p.z - (11 - std::sqrt(25 - d * d))));
        on_ridge += d > 1 - 0.1 * pitch && std::abs(normal.y) > 0.1 ? 1 : 0;
      });
      EXPECT_LT(worst, 0.01 * pitch) << to_string(rays) << " " << pitch;
      // Both ridges, one vertex per side.
      EXPECT_GT(on_ridge, 4 * 9 / pitch) << to_string(rays) << " " << pitch;
    }
  }
}

TEST(SharpSurface, ThreeFieldsPlaceWallsExactly) {
  const double pitch = 0.5;
  Sculpture s = sculpture_of(BoxStock{{0, 0, 0}, {30, 30, 6}}, pitch, Rays::kTriDexel);
  EXPECT_TRUE(s.apply(DefineTool{1, *make_tool(FlatShape{4, 40})}));
  EXPECT_TRUE(s.apply(MoveTool{1, {{4, 8, 2.2}}, {{26, 15, 2.2}}, 1, false}));
  const Vec3 along = normalized({22, 7, 0});
  double wall = 0, floor = 0, rim = 0;
  for_vertices(s, [&](Vec3 p, Vec3 normal) {
    const Vec3 from = p - Vec3{4, 8, p.z};
    const double distance = dot(from, along);
    const double off = std::abs(p.y * along.x - p.x * along.y - (8 * along.x - 4 * along.y));
    if (distance < 2 || distance > 20 || off > 2.6 || p.z < 1) return;
    if (std::abs(normal.z) < 0.1) wall = std::max(wall, std::abs(off - 2));
    if (normal.z > 0.9 && p.z < 5) floor = std::max(floor, std::abs(p.z - 2.2));
    if (normal.z > 0.9 && p.z < 5) rim = std::max(rim, off);
  });
  EXPECT_LT(wall, 0.002 * pitch);
  EXPECT_LT(floor, 1e-5);
  EXPECT_NEAR(rim, 2, 0.002 * pitch);
}

/// Rays along Z meet the steep side of a ball's slot at most once per pitch; the surface is
/// extrapolated from the ends behind. The slice is a circle along the grid, otherwise an ellipse.
TEST(SharpSurface, OneFieldFollowsTheSidesOfABallsSlot) {
  for (const Vec3 travel : {Vec3{0, 24, 0}, Vec3{12, 24, 0}, Vec3{24, 15, 0}}) {
    const double pitch = 0.5;
    Sculpture s = sculpture_of(BoxStock{{0, 0, 0}, {30, 30, 12}}, pitch, Rays::kDexel);
    EXPECT_TRUE(s.apply(DefineTool{1, *make_tool(BallShape{10, 50})}));
    const Vec3 from{15.13 - travel.x / 2, 15.07 - travel.y / 2, 4};
    EXPECT_TRUE(s.apply(MoveTool{1, {from}, {from + travel}, 1, false}));
    const Vec3 along = normalized(travel);
    double side = 0;
    int count = 0;
    for_vertices(s, [&](Vec3 p, Vec3) {
      const Vec3 q = p - (from + travel * 0.5 + Vec3{0, 0, 5});
      const Vec3 across = q - along * dot(q, along);
      // Below the equator, near the middle of the path.
      if (std::abs(dot(q, along)) > 6 || across.z > -0.3 || length(across) > 7 || p.z < 1) return;
      side = std::max(side, std::abs(length(across) - 5));
      ++count;
    });
    EXPECT_GT(count, 500);
    EXPECT_LT(side, 0.06 * pitch) << travel.x;
  }
}

/// A wall that no ray meets is between two columns, and no vertex of it is farther away than that.
TEST(SharpSurface, OneFieldPlacesWallsToHalfAPitch) {
  const double pitch = 0.5;
  for (const double turn : {0.0, 0.1, 0.35, 0.7}) {
    Sculpture s = sculpture_of(BoxStock{{0, 0, 0}, {30, 30, 6}}, pitch, Rays::kDexel);
    EXPECT_TRUE(s.apply(DefineTool{1, *make_tool(FlatShape{4, 40})}));
    const Vec3 along{std::cos(turn), std::sin(turn), 0}, middle{15.2, 14.9, 2.2};
    EXPECT_TRUE(s.apply(MoveTool{1, {middle - along * 10}, {middle + along * 10}, 1, false}));
    double wall = 0;
    for_vertices(s, [&](Vec3 p, Vec3) {
      const Vec3 q = p - middle;
      const double off = length(q - along * dot(q, along) - Vec3{0, 0, q.z});
      if (std::abs(dot(q, along)) > 9 || off > 3 || p.z < 2.5 || p.z > 5.7) return;
      wall = std::max(wall, std::abs(off - 2));
    });
    EXPECT_GT(wall, 0) << turn;
    EXPECT_LE(wall, 0.6 * pitch) << turn;
  }
}

TEST(SharpSurface, CylinderStockIsRoundForBothRayModels) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    Sculpture s = sculpture_of(CylinderStock{3, -2, 8, 0, 10}, 0.5, rays);
    double worst = 0, normals = 0;
    for_vertices(s, [&](Vec3 p, Vec3 normal) {
      const Vec3 from_axis{p.x - 3, p.y + 2, 0};
      if (std::abs(normal.z) > 0.5) return;
      worst = std::max(worst, std::abs(length(from_axis) - 8));
      normals = std::max(normals, length(normal - normalized(from_axis)));
    });
    EXPECT_LT(worst, 0.02 * 0.5) << to_string(rays);
    EXPECT_LT(normals, 0.05) << to_string(rays);
  }
}

TEST(SharpSurface, FacesAreExactIfThePitchDoesNotDivideTheStock) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    const Vec3 low{1, 2, 3}, high{13.07, 10.31, 8.18};
    Sculpture s = sculpture_of(BoxStock{low, high}, 0.5, rays);
    for_vertices(s, [&](Vec3 p, Vec3) {
      const auto off = [](double v, double a, double b) {
        return std::min(std::abs(v - a), std::abs(v - b));
      };
      const double nearest =
          std::min({off(p.x, low.x, high.x), off(p.y, low.y, high.y), off(p.z, low.z, high.z)});
      EXPECT_LT(nearest, 2e-6);
    });
  }
}

/// A motion that only rays along X meet changes the surface of a tile, which must be reported.
TEST(SharpSurface, ReportsTilesChangedOnlyInHorizontalFields) {
  Sculpture s = sculpture_of(BoxStock{{0, 0, 0}, {40, 40, 20}}, 1, Rays::kTriDexel);
  EXPECT_TRUE(s.apply(DefineTool{1, *make_tool(BallShape{4, 40})}));
  // From the side, 0.3 mm deep into the face at x = 40. No ray along Z is met: the first is 0.5 mm
  // inside.
  const auto result =
      s.apply(MoveTool{1, {{39.7, 10, 10}, {1, 0, 0}}, {{39.7, 36, 10}, {1, 0, 0}}, 1, false});
  ASSERT_TRUE(result);
  EXPECT_TRUE(std::ranges::count(result->changed_tiles, TileIndex{1, 0}) == 1);
  EXPECT_TRUE(std::ranges::count(result->changed_tiles, TileIndex{1, 1}) == 1);
}

}  // namespace
}  // namespace kerf::sharp_surface_test
