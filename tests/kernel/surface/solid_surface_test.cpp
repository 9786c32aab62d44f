// SPDX-License-Identifier: Apache-2.0
// The surface for export: closed where squares of untouched faces meet carved tiles, with a size
// proportional to the cut, not to the block.

#include "kernel/surface/solid_surface.h"

#include "tests/support/carvings.h"
#include "tests/support/extreme_block.h"
#include "tests/support/mesh_check.h"
#include "tests/support/test.h"

namespace kerf::solid_surface_test {
namespace {

using test::MeshReport;

std::vector<TileMesh> pieces_of(SolidSurface& surface) {
  std::vector<TileMesh> pieces;
  for (TileMesh piece; surface.next(piece);) pieces.push_back(piece);
  return pieces;
}

void expect_closed(const MeshReport& report) {
  EXPECT_EQ(report.open_edges, 0U);
  EXPECT_EQ(report.repeated_edges, 0U);
  EXPECT_EQ(report.degenerate, 0U);
  EXPECT_EQ(report.bad_normals, 0U);
}

/// Expects the surface to be closed and to enclose the same solid as the tiles' meshes, to the
/// margin that vertices keep from their cells' lower sides. Returns its number of triangles.
std::size_t expect_same_solid(const SolidSnapshot& solid) {
  SolidSurface surface(solid);
  const MeshReport merged = test::check_mesh(pieces_of(surface));
  const MeshReport tiles = test::check_mesh(test::mesh_all(solid));
  expect_closed(merged);
  // A fan about a center has two triangles more than its rim needs.
  EXPECT_LE(merged.triangles, tiles.triangles + 2 * surface.squares());
  const BoxStock box = stock_bounds(solid.fields.front().stock());
  const Vec3 size = box.max_mm - box.min_mm;
  const double margin_mm = solid.grid().pitch_mm / 1000;
  const double area = size.x * size.y + size.y * size.z + size.z * size.x;
  EXPECT_NEAR(merged.volume_mm3, tiles.volume_mm3, 2 * area * margin_mm);
  return merged.triangles;
}

SculptureSettings settings_of(StockShape stock, double pitch_mm, Rays rays) {
  return SculptureSettings{.stock = stock, .rays = rays, .pitch_mm = pitch_mm};
}

TEST(SolidSurface, UntouchedBoxHasTwelveTriangles) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    for (const double size : {1.0, 7.3, 40.0, 1000.0}) {
      SculptureSettings s =
          settings_of(BoxStock{{-3, 2, 1}, {-3 + size, 2 + size / 3, 1 + size / 5}}, 0.25, rays);
      SolidSurface surface(Sculpture::create(s)->solid());
      const MeshReport report = test::check_mesh(pieces_of(surface));
      expect_closed(report);
      EXPECT_EQ(report.triangles, 12U);
      EXPECT_EQ(surface.tiles(), 0U);
      EXPECT_NEAR(report.volume_mm3 / (size * size * size / 15), 1, 1e-5);
    }
  }
}

TEST(SolidSurface, RandomCutsGiveTheSolidOfTheTiles) {
  for (unsigned seed = 1; seed <= 18; ++seed) {
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + " " + to_string(rays));
      const Vec3 low{-20, 15, 3};
      const Vec3 size =
          std::array{Vec3{90, 70, 12}, Vec3{17, 90, 40}, Vec3{33.1, 29.8, 60}}[seed % 3];
      Sculpture sculpture = *Sculpture::create(settings_of(BoxStock{low, low + size}, 0.5, rays));
      // A part of the block, mostly at its sides, is carved.
      const Vec3 from = low + Vec3{-2, 0.2 * size.y, 0.4 * size.z};
      test::RandomCarver carver(sculpture, from, from + Vec3{12, 12, 0.7 * size.z}, seed);
      for (unsigned n = 0; n < 1 + seed % 6; ++n) carver.cut();
      expect_same_solid(sculpture.solid());
    }
  }
}

TEST(SolidSurface, CylinderMergesItsDiscs) {
  Sculpture sculpture =
      *Sculpture::create(settings_of(CylinderStock{3, -2, 60, 0, 3}, 0.5, Rays::kTriDexel));
  const SolidSnapshot untouched = sculpture.solid();
  EXPECT_LT(expect_same_solid(untouched),
            test::check_mesh(test::mesh_all(untouched)).triangles * 9 / 10);
  test::RandomCarver carver(sculpture, {10, 0, 1}, {20, 10, 5}, 5);
  for (int n = 0; n < 5; ++n) carver.cut();
  expect_same_solid(sculpture.solid());
  // Only the tiles on the circumference are meshed.
  Sculpture large =
      *Sculpture::create(settings_of(CylinderStock{0, 0, 4000, 0, 3}, 0.5, Rays::kDexel));
  const double tiles_across = 8000 / 0.5 / kTileSide;
  EXPECT_LT(double(SolidSurface(large.solid()).tiles()), 10 * tiles_across);
}

TEST(SolidSurface, ExtremeProportionsStayClosed) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + " " + to_string(rays));
      expect_same_solid(test::ExtremeBlock(seed, rays).make(int(seed % 4)).solid());
    }
  }
}

/// The part of a surface's cost that the tests compare.
struct Cost {
  std::size_t triangles, tiles, squares;
};

/// Carves a pocket and a dent into a block, at its middle or at its corner.
Cost cost_of_cut(Vec3 size, bool at_corner, Rays rays) {
  const Vec3 low{-size.x / 2, -size.y / 2, -size.z};
  Sculpture sculpture = *Sculpture::create(settings_of(BoxStock{low, low + size}, 0.5, rays));
  EXPECT_TRUE(sculpture.apply(DefineTool{1, make_tool(FlatShape{12, 60}).value()}));
  EXPECT_TRUE(sculpture.apply(DefineTool{2, make_tool(BallShape{20, 60}).value()}));
  // Multiples of a tile's side, so that the cut has the same position in the lattice of each block.
  const Vec3 at = at_corner ? Vec3{low.x + 10, low.y + 10, 0} : Vec3{};
  EXPECT_TRUE(
      sculpture.apply(MoveTool{1, {at + Vec3{-15, 0, -6}}, {at + Vec3{15, 3, -6}}, 1, false}));
  EXPECT_TRUE(
      sculpture.apply(MoveTool{2, {at + Vec3{-10, 12, -5}}, {at + Vec3{20, 20, -9}}, 1, false}));
  SolidSurface surface(sculpture.solid());
  const MeshReport report = test::check_mesh(pieces_of(surface));
  expect_closed(report);
  const double removed = size.x * size.y * size.z - report.volume_mm3;
  EXPECT_NEAR(removed, sculpture.removed_volume_mm3(),
              0.05 * sculpture.removed_volume_mm3() + 1e-6 * size.x * size.y * size.z);
  return {report.triangles, surface.tiles(), surface.squares()};
}

TEST(SolidSurface, CostGrowsWithTheCarvedArea) {
  const Vec3 small{128, 128, 48};
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    for (const bool at_corner : {false, true}) {
      SCOPED_TRACE(std::string(to_string(rays)) + (at_corner ? " corner" : " middle"));
      const Cost of_small = cost_of_cut(small, at_corner, rays);
      for (const Vec3 large : {Vec3{10240, 10240, 96}, Vec3{10240, 10240, 10240}}) {
        const Cost of_large = cost_of_cut(large, at_corner, rays);
        EXPECT_LT(of_large.triangles, 2 * of_small.triangles);
        EXPECT_LE(of_large.tiles, of_small.tiles + 8);
        EXPECT_LT(of_large.squares, 1200U);
      }
    }
  }
}

}  // namespace
}  // namespace kerf::solid_surface_test
