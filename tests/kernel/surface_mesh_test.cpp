// SPDX-License-Identifier: Apache-2.0
#include "tests/support/carvings.h"
#include "tests/support/mesh_check.h"
#include "tests/support/test.h"

namespace kerf::surface_mesh_test {
namespace {

using test::check_mesh;
using test::make_sculpture;
using test::mesh_all;
using test::MeshReport;
using test::RandomCarver;

const BoxStock kBlock{{-10, 5, -3}, {15, 24, 9}};

void expect_closed(const MeshReport& report) {
  EXPECT_EQ(report.open_edges, 0U);
  EXPECT_EQ(report.repeated_edges, 0U);
  EXPECT_EQ(report.degenerate, 0U);
  EXPECT_EQ(report.bad_normals, 0U);
}

TEST(SurfaceMesh, UntouchedBoxIsExact) {
  for (const double pitch : {0.5, 0.25, 0.1}) {
    Sculpture sculpture = make_sculpture(BoxStock{{1, 2, 3}, {13, 10, 8}}, pitch);
    const auto meshes = mesh_all(sculpture.solid());
    const MeshReport report = check_mesh(meshes);
    expect_closed(report);
    EXPECT_NEAR(report.volume_mm3, 12 * 8 * 5, 1e-3) << pitch;
    std::array<float, 3> low{1e9F, 1e9F, 1e9F}, high{-1e9F, -1e9F, -1e9F};
    for (const TileMesh& mesh : meshes) {
      for (const auto& p : mesh.positions_mm) {
        for (std::size_t c = 0; c < 3; ++c) {
          low[c] = std::min(low[c], p[c]);
          high[c] = std::max(high[c], p[c]);
        }
      }
    }
    EXPECT_EQ(low, (std::array<float, 3>{0, 0, 0}));
    EXPECT_NEAR(high[0], 12, 1e-5);
    EXPECT_NEAR(high[1], 8, 1e-5);
    EXPECT_EQ(high[2], 5);
  }
}

TEST(SurfaceMesh, BoxEdgesHaveSeparateNormals) {
  Sculpture sculpture = make_sculpture(BoxStock{{0, 0, 0}, {6, 6, 6}}, 0.5);
  for (const TileMesh& mesh : mesh_all(sculpture.solid())) {
    for (const auto& n : mesh.normals) {
      EXPECT_EQ(std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]), 1);
    }
  }
}

TEST(SurfaceMesh, RandomCarvingsAreClosedManifolds) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    Sculpture sculpture = make_sculpture(kBlock, seed % 2 == 0 ? 0.25 : 0.4);
    RandomCarver carver(sculpture, kBlock.min_mm, kBlock.max_mm, seed);
    for (unsigned n = 0; n < 10 * seed; ++n) carver.cut();
    const DexelSnapshot snapshot = sculpture.snapshot();
    const MeshReport report = check_mesh(mesh_all(sculpture.solid()));
    expect_closed(report);
    EXPECT_GT(report.triangles, 1000U);
    // Positive only if the triangles face outward. The difference is below the lattice's
    // resolution.
    Sculpture fine = make_sculpture(kBlock, 0.1);
    RandomCarver again(fine, kBlock.min_mm, kBlock.max_mm, seed);
    for (unsigned n = 0; n < 10 * seed; ++n) again.cut();
    const double volume = fine.snapshot().volume_mm3();
    EXPECT_NEAR(report.volume_mm3, volume, 0.015 * volume);
  }
}

TEST(SurfaceMesh, CylinderStockIsRound) {
  Sculpture sculpture = make_sculpture(CylinderStock{3, -2, 8, 0, 10}, 0.25);
  const DexelSnapshot snapshot = sculpture.snapshot();
  const auto meshes = mesh_all(sculpture.solid());
  expect_closed(check_mesh(meshes));
  EXPECT_NEAR(check_mesh(meshes).volume_mm3, std::numbers::pi * 64 * 10, 0.005 * 2010);
  const Vec3 center = Vec3{3, -2, 0} - snapshot.grid().origin_mm;
  for (const TileMesh& mesh : meshes) {
    for (const auto& p : mesh.positions_mm) {
      const double r = std::hypot(double(p[0]) - center.x, double(p[1]) - center.y);
      EXPECT_LT(r, 8 + 0.6 * 0.25);
    }
  }
}

TEST(SurfaceMesh, BallDentFollowsTheBall) {
  const double pitch = 0.25;
  Sculpture sculpture = make_sculpture(BoxStock{{-10, -10, -10}, {10, 10, 0}}, pitch);
  ASSERT_TRUE(sculpture.apply(DefineTool{1, make_tool(BallShape{12, 40}).value()}));
  ASSERT_TRUE(sculpture.apply(MoveTool{1, {{0.1, 0.03, -4}}, {{0.1, 0.03, -4}}, 1, false}));
  const DexelSnapshot snapshot = sculpture.snapshot();
  double worst_mm = 0, worst_normal = 0;
  for (const TileMesh& mesh : mesh_all(sculpture.solid())) {
    for (std::size_t v = 0; v < mesh.positions_mm.size(); ++v) {
      const auto& q = mesh.positions_mm[v];
      const Vec3 p = Vec3{double(q[0]), double(q[1]), double(q[2])} + snapshot.grid().origin_mm;
      const Vec3 from_center = p - Vec3{0.1, 0.03, 2};
      // Excludes the rim, which is a crease, and the walls and the bottom of the block.
      if (p.z > -0.5 || p.z < -5 || std::hypot(p.x, p.y) > 7) continue;
      worst_mm = std::max(worst_mm, std::abs(length(from_center) - 6));
      const auto& n = mesh.normals[v];
      const Vec3 normal{double(n[0]), double(n[1]), double(n[2])};
      worst_normal = std::max(worst_normal, 1 + dot(normal, normalized(from_center)));
    }
  }
  EXPECT_LT(worst_mm, 0.02 * pitch * 6);
  EXPECT_LT(worst_normal, 0.01);  // 1 - cos
}

TEST(SurfaceMesh, FloorOfAPocketKeepsItsHeight) {
  Sculpture sculpture = make_sculpture(BoxStock{{0, 0, 0}, {20, 20, 10}}, 0.25);
  ASSERT_TRUE(sculpture.apply(DefineTool{1, make_tool(FlatShape{6, 40}).value()}));
  ASSERT_TRUE(sculpture.apply(MoveTool{1, {{5, 10, 6.13}}, {{15, 10, 6.13}}, 1, false}));
  std::size_t floor = 0, wall = 0;
  for (const TileMesh& mesh : mesh_all(sculpture.solid())) {
    for (std::size_t v = 0; v < mesh.positions_mm.size(); ++v) {
      const auto& p = mesh.positions_mm[v];
      const bool inside = std::abs(p[0] - 10) < 8.2F && std::abs(p[1] - 10) < 3.2F;
      if (!inside || p[2] < 1) continue;
      if (mesh.normals[v][2] > 0.9F && p[2] < 9.9F) {
        ++floor;
        EXPECT_NEAR(p[2], 6.13F, 1e-4F);
      } else if (p[2] > 6.5F && p[2] < 9.5F) {
        ++wall;
        EXPECT_EQ(mesh.normals[v][2], 0);
      }
    }
  }
  EXPECT_GT(floor, 10U);
  EXPECT_GT(wall, 100U);
}

TEST(SurfaceMesh, ObliqueWallsAreStraight) {
  Sculpture sculpture = make_sculpture(BoxStock{{0, 0, 0}, {30, 30, 5}}, 0.25);
  ASSERT_TRUE(sculpture.apply(DefineTool{1, make_tool(FlatShape{4, 40}).value()}));
  ASSERT_TRUE(sculpture.apply(MoveTool{1, {{4, 8, 1}}, {{26, 15, 1}}, 1, false}));
  const Vec3 along = normalized({22, 7, 0});
  double worst_mm = 0;
  for (const TileMesh& mesh : mesh_all(sculpture.solid())) {
    for (const auto& q : mesh.positions_mm) {
      const Vec3 p = Vec3{double(q[0]), double(q[1]), double(q[2])} - Vec3{4, 8, 0};
      const double s = dot(p, along);
      if (s < 2 || s > 20 || q[2] < 1.5F || q[2] > 4.5F) continue;
      const double off = std::abs(p.y * along.x - p.x * along.y);
      if (off < 3) worst_mm = std::max(worst_mm, std::abs(off - 2));
    }
  }
  EXPECT_GT(worst_mm, 0);
  EXPECT_LT(worst_mm, 0.45 * 0.25);  // a staircase would be off by up to 0.68 pitches
}

/// The columns of a tile in which two views of a block with one field differ, if any do.
std::optional<ChangedColumns> difference(const DexelSnapshot& a, const DexelSnapshot& b,
                                         TileIndex tile) {
  ChangedColumns found{tile, kTileSide, kTileSide, 0, 0};
  std::vector<Dexel> of_a, of_b;
  for (std::int32_t y = 0; y < kTileSide; ++y) {
    for (std::int32_t x = 0; x < kTileSide; ++x) {
      const std::int32_t i = tile.x * kTileSide + x, j = tile.y * kTileSide + y;
      if (std::ranges::equal(a.column(i, j, of_a), b.column(i, j, of_b))) continue;
      found.begin_x = std::min(found.begin_x, x);
      found.begin_y = std::min(found.begin_y, y);
      found.end_x = std::max(found.end_x, x + 1);
      found.end_y = std::max(found.end_y, y + 1);
    }
  }
  if (found.end_x == 0) return std::nullopt;
  return found;
}

TEST(SurfaceMesh, ChangesOnlyWhereItReadsChangedColumns) {
  Sculpture sculpture = make_sculpture(kBlock, 0.25);
  RandomCarver carver(sculpture, kBlock.min_mm, kBlock.max_mm, 9);
  const DexelGrid& grid = sculpture.grid();
  auto meshes = mesh_all(sculpture.solid());
  std::size_t fewer = 0;
  for (int n = 0; n < 40; ++n) {
    const SolidSnapshot before = sculpture.solid();
    const auto tiles = carver.cut();
    const SolidSnapshot solid = sculpture.solid();
    std::vector<ChangedColumns> changed;
    for (const TileIndex tile : tiles) {
      const auto columns = difference(before.fields.front(), solid.fields.front(), tile);
      if (columns) changed.push_back(*columns);
    }
    const std::vector<TileIndex> reading = tiles_that_read(grid, changed);
    fewer += tiles_to_remesh(grid, tiles).size() - reading.size();
    for (const TileIndex tile : reading) {
      meshes[std::size_t(tile.y * grid.tiles_x() + tile.x)] = mesh_tile(solid, tile);
    }
  }
  EXPECT_GT(fewer, 20U);
  EXPECT_EQ(check_mesh(meshes).hash, check_mesh(mesh_all(sculpture.solid())).hash);
}

TEST(SurfaceMesh, TilesDoNotDependOnOrderOrHistory) {
  Sculpture sculpture = make_sculpture(kBlock, 0.25);
  RandomCarver carver(sculpture, kBlock.min_mm, kBlock.max_mm, 7);
  const DexelGrid& grid = sculpture.grid();
  auto meshes = mesh_all(sculpture.solid());
  for (int n = 0; n < 40; ++n) {
    const auto changed = carver.cut();
    const SolidSnapshot solid = sculpture.solid();
    for (const TileIndex tile : tiles_to_remesh(grid, changed)) {
      meshes[std::size_t(tile.y * grid.tiles_x() + tile.x)] = mesh_tile(solid, tile);
    }
  }
  EXPECT_EQ(check_mesh(meshes).hash, check_mesh(mesh_all(sculpture.solid())).hash);
  expect_closed(check_mesh(meshes));
}

TEST(SurfaceMesh, FeaturesBelowTheLatticeVanishWithoutHoles) {
  Sculpture sculpture = make_sculpture(BoxStock{{0, 0, 0}, {10, 10, 4}}, 0.5);
  ASSERT_TRUE(sculpture.apply(DefineTool{1, make_tool(FlatShape{3, 40}).value()}));
  // Everything below z = 3.45 is removed down to a floor, under a skin of 0.05 that contains no
  // sample.
  const Vec3 sideways{1, 0, 0};
  ASSERT_TRUE(
      sculpture.apply(MoveTool{1, {{-1, 5, 2.4}, sideways}, {{-1, 5, 2.4}, sideways}, 1, false}));
  const MeshReport report = check_mesh(mesh_all(sculpture.solid()));
  expect_closed(report);
  EXPECT_GT(report.volume_mm3, 0);
}

TEST(SurfaceMesh, EmptyBlockHasNoTriangles) {
  Sculpture sculpture = make_sculpture(BoxStock{{0, 0, 0}, {4, 4, 4}}, 0.5);
  ASSERT_TRUE(sculpture.apply(DefineTool{1, make_tool(FlatShape{20, 40}).value()}));
  ASSERT_TRUE(sculpture.apply(MoveTool{1, {{2, 2, -1}}, {{2, 2, -1}}, 1, false}));
  EXPECT_EQ(check_mesh(mesh_all(sculpture.solid())).triangles, 0U);
}

TEST(SurfaceMesh, BytesAreTheSameEverywhere) {
  Sculpture sculpture = make_sculpture(kBlock, 0.4);
  RandomCarver carver(sculpture, kBlock.min_mm, kBlock.max_mm, 99);
  // Only balls at rest, so that the hash depends on the mesher, not on the sweeps.
  for (int n = 0; n < 40; ++n) {
    const double x = carver.uniform(-10, 15);
    const double y = carver.uniform(5, 24);
    const ToolPose pose{{x, y, carver.uniform(-5, 8)}};
    ASSERT_TRUE(sculpture.apply(MoveTool{1, pose, pose, 1, false}));
  }
  EXPECT_EQ(check_mesh(mesh_all(sculpture.solid())).hash, 8944592604410455207U);
}

TEST(TilesToRemesh, AreTheTileAndItsNeighborsWithinTheGrid) {
  DexelGrid grid{.columns_x = 32 * 3, .columns_y = 32 * 2};
  const std::vector<TileIndex> expected{{0, 0}, {0, 1}, {1, 0}, {1, 1}, {2, 0}, {2, 1}};
  EXPECT_EQ(tiles_to_remesh(grid, {{0, 0}}),
            (std::vector<TileIndex>{{0, 0}, {0, 1}, {1, 0}, {1, 1}}));
  EXPECT_EQ(tiles_to_remesh(grid, {{2, 1}, {0, 0}, {2, 1}}), expected);
  EXPECT_TRUE(tiles_to_remesh(grid, {}).empty());
}

TEST(TilesToRemesh, AreTheNeighborsThatReadTheChangedColumns) {
  DexelGrid grid;
  grid.columns_x = grid.columns_y = 32 * 3;
  const auto reading = [&](std::int32_t begin_x, std::int32_t end_x) {
    const ChangedColumns columns{{1, 1}, begin_x, 10, end_x, 20};
    return tiles_that_read(grid, {&columns, 1});
  };
  using Tiles = std::vector<TileIndex>;
  EXPECT_EQ(reading(4, 28), (Tiles{{1, 1}}));
  EXPECT_EQ(reading(3, 28), (Tiles{{0, 1}, {1, 1}}));
  EXPECT_EQ(reading(4, 29), (Tiles{{1, 1}, {2, 1}}));
  const ChangedColumns corner{{1, 1}, 0, 0, 2, 2};
  EXPECT_EQ(tiles_that_read(grid, {&corner, 1}), (Tiles{{0, 0}, {0, 1}, {1, 0}, {1, 1}}));
}

}  // namespace
}  // namespace kerf::surface_mesh_test
