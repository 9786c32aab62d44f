// SPDX-License-Identifier: Apache-2.0
#include "server/feed/tile_detail.h"

#include "tests/support/carvings.h"
#include "tests/support/drawn_error.h"
#include "tests/support/mesh_check.h"
#include "tests/support/test.h"

namespace kerf::tile_detail_test {
namespace {

const BoxStock kBlock{{-3, 2, 1}, {28, 28, 9}};

Sculpture carved_block(unsigned seed, Rays rays, int cuts) {
  Sculpture sculpture =
      std::move(Sculpture::create({.stock = kBlock, .rays = rays, .pitch_mm = 0.25}).value());
  test::RandomCarver carver(sculpture, kBlock.min_mm, kBlock.max_mm, seed);
  for (int n = 0; n < cuts; ++n) carver.cut();
  return sculpture;
}

/// Returns tiles at the levels given by `level`. A border has the finer level of its two tiles.
template <typename Level>
std::vector<TileMesh> mesh_at(const std::vector<TileMesh>& exact, const DexelGrid& grid,
                              const Level& level) {
  std::vector<TileMesh> meshes;
  for (const TileMesh& mesh : exact) {
    TileDetail detail{.level = level(mesh.tile), .side = {}};
    for (std::size_t n = 0; n < kSides.size(); ++n) {
      const TileIndex beside{mesh.tile.x + kSides[n].x, mesh.tile.y + kSides[n].y};
      const bool inside =
          beside.x >= 0 && beside.y >= 0 && beside.x < grid.tiles_x() && beside.y < grid.tiles_y();
      if (inside) detail.side[n] = std::min(detail.level, level(beside));
    }
    meshes.push_back(coarser_tile(mesh, grid, detail));
  }
  return meshes;
}

double area_mm2(const std::vector<TileMesh>& meshes) {
  double area = 0;
  for (const TileMesh& mesh : meshes) {
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
      const auto at = [&](std::size_t c) {
        const auto& p = mesh.positions_mm[mesh.indices[t + c]];
        return Vec3{double(p[0]), double(p[1]), double(p[2])};
      };
      area += length(cross(at(1) - at(0), at(2) - at(0))) / 2;
    }
  }
  return area;
}

class TileDetailOfRays : public testing::TestWithParam<Rays> {};

TEST_P(TileDetailOfRays, MeshIsClosedAtAnyCombinationOfLevels) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Sculpture sculpture = carved_block(seed, GetParam(), 12 + 5 * int(seed));
    const DexelGrid& grid = sculpture.grid();
    const auto exact = test::mesh_all(sculpture.solid());
    std::mt19937 random(seed);
    std::vector<std::uint8_t> levels(exact.size());
    for (int pattern = 0; pattern < 3; ++pattern) {
      for (auto& level : levels) level = std::uint8_t(random() % (kDetailLevelMax + 1));
      const auto level = [&](TileIndex tile) {
        return levels[std::size_t(tile.y * grid.tiles_x() + tile.x)];
      };
      const auto report = test::check_mesh(mesh_at(exact, grid, level));
      EXPECT_EQ(report.open_edges, 0U) << "seed " << seed << ", pattern " << pattern;
      EXPECT_EQ(report.degenerate, 0U);
      EXPECT_EQ(report.bad_normals, 0U);
    }
  }
}

TEST_P(TileDetailOfRays, CoarserLevelsHaveFewerTrianglesWithinTheirError) {
  Sculpture sculpture = carved_block(3, GetParam(), 8);
  const DexelGrid& grid = sculpture.grid();
  const auto exact = test::mesh_all(sculpture.solid());
  const double area = area_mm2(exact);
  auto finer = test::check_mesh(exact);
  const double volume = finer.volume_mm3;
  for (std::uint8_t level = 1; level <= kDetailLevelMax; ++level) {
    const auto report =
        test::check_mesh(mesh_at(exact, grid, [level](TileIndex) { return level; }));
    EXPECT_EQ(report.open_edges, 0U);
    EXPECT_LT(report.triangles, finer.triangles);
    EXPECT_NEAR(report.volume_mm3, volume, area * detail_error_mm(level, grid.pitch_mm));
    finer = report;
  }
}

TEST_P(TileDetailOfRays, CoarserLevelsKeepOriginalSurfaceFlags) {
  Sculpture sculpture = carved_block(3, GetParam(), 4);
  const auto exact = test::mesh_all(sculpture.solid());
  std::size_t original = 0, all = 0;
  for (const std::uint8_t level : {std::uint8_t{1}, std::uint8_t{3}}) {
    const auto coarse = mesh_at(exact, sculpture.grid(), [level](TileIndex) { return level; });
    for (std::size_t tile = 0; tile < coarse.size(); ++tile) {
      using Vertex = std::tuple<std::array<float, 3>, std::array<float, 3>, std::uint8_t>;
      const auto vertices_of = [](const TileMesh& mesh) {
        std::set<Vertex> vertices;
        for (std::size_t v = 0; v < mesh.positions_mm.size(); ++v) {
          vertices.emplace(mesh.positions_mm[v], mesh.normals[v], mesh.original.at(v));
        }
        return vertices;
      };
      const auto kept = vertices_of(coarse[tile]), whole = vertices_of(exact[tile]);
      EXPECT_TRUE(std::ranges::includes(whole, kept)) << "level " << int{level};
      for (const Vertex& vertex : kept) original += std::get<2>(vertex);
      all += kept.size();
    }
  }
  EXPECT_GT(original, 20U);
  EXPECT_GT(all - original, 20U);
}

/// A block with shallow grooves of a thin ball in all directions, which run across the borders of
/// its tiles.
Sculpture grooved_block(Rays rays) {
  Sculpture sculpture =
      std::move(Sculpture::create({.stock = kBlock, .rays = rays, .pitch_mm = 0.25}).value());
  sculpture.apply(DefineTool{1, *make_tool(BallShape{2, 30})}).value();
  const Vec3 middle{12.3, 15.2, 8.6}, up{0, 0, 1};
  constexpr int kGrooves = 14;
  for (int n = 0; n < kGrooves; ++n) {
    const double angle = (n + 0.13) * 2 * std::numbers::pi / kGrooves;
    const Vec3 arm{std::cos(angle), std::sin(angle), 0};
    sculpture.apply(MoveTool{1, {middle + arm * 4, up}, {middle + arm * 12, up}}).value();
  }
  return sculpture;
}

TEST_P(TileDetailOfRays, CoarserLevelsKeepSkinAndShading) {
  Sculpture sculpture = grooved_block(GetParam());
  const auto exact = test::mesh_all(sculpture.solid());
  for (const std::uint8_t level : {std::uint8_t{1}, std::uint8_t{2}}) {
    const auto coarse = mesh_at(exact, sculpture.grid(), [level](TileIndex) { return level; });
    auto error = test::drawn_error(exact, coarse, sculpture.grid().pitch_mm, 0.12);
    EXPECT_LT(error.wrong_skin, 4e-4) << "level " << int{level};
    std::ranges::sort(error.turns);
    EXPECT_LT(error.turns[error.turns.size() * 98 / 100], 0.06) << "level " << int{level};
  }
}

INSTANTIATE_TEST_SUITE_P(, TileDetailOfRays, testing::Values(Rays::kDexel, Rays::kTriDexel));

TEST(TileDetail, LevelZeroIsTheExactMesh) {
  Sculpture sculpture = carved_block(2, Rays::kDexel, 10);
  const auto exact = test::mesh_all(sculpture.solid());
  const auto same = mesh_at(exact, sculpture.grid(), [](TileIndex) { return std::uint8_t{0}; });
  EXPECT_EQ(test::check_mesh(same).hash, test::check_mesh(exact).hash);
}

TEST(TileDetail, FlatBlockHasFewTriangles) {
  Sculpture sculpture = carved_block(1, Rays::kDexel, 0);
  const auto exact = test::mesh_all(sculpture.solid());
  const auto coarse =
      test::check_mesh(mesh_at(exact, sculpture.grid(), [](TileIndex) { return std::uint8_t{1}; }));
  EXPECT_EQ(coarse.open_edges, 0U);
  EXPECT_LT(5 * coarse.triangles, test::check_mesh(exact).triangles);
  EXPECT_NEAR(coarse.volume_mm3, 31 * 26 * 8, 0.01);
}

TEST(TileDetail, TilesWithDifferentBorderLevelsLeaveCracks) {
  Sculpture sculpture = carved_block(4, Rays::kDexel, 20);
  const DexelGrid& grid = sculpture.grid();
  auto meshes = test::mesh_all(sculpture.solid());
  // Counter-test of MeshIsClosedAtAnyCombinationOfLevels: this tile ignores its neighbors' levels.
  meshes[0] = coarser_tile(meshes[0], grid, {.level = 2, .side = {2, 2, 2, 2}});
  EXPECT_GT(test::check_mesh(meshes).open_edges, 0U);
}

TEST(TileDetail, LevelDependsOnTheDistanceToTheTile) {
  DexelGrid grid{.pitch_mm = 0.25};
  grid.columns_x = grid.columns_y = 320;
  grid.z_quantum_mm = std::exp2(-20);
  grid.height_quanta = 10 << 20;
  const auto level = [&](Vec3 eye, double error_rad, TileIndex tile, int current = 0) {
    return detail_level({eye, error_rad}, grid, tile, current);
  };
  EXPECT_EQ(level({4, 4, 1000}, 0, {0, 0}), 0);
  EXPECT_EQ(level({4, 4, 5}, 0.001, {0, 0}), 0);      // inside the tile
  EXPECT_EQ(level({4, 4, 10000}, 0.001, {0, 0}), 3);  // 10 mm allowed
  // About 0.04 mm allowed: the error of level 1 is 0.031 mm, with the margin 0.039 mm.
  EXPECT_EQ(level({4, 4, 50}, 0.001, {0, 0}), 1);
  EXPECT_EQ(level({4, 4, 45}, 0.001, {0, 0}), 0);     // below the margin
  EXPECT_EQ(level({4, 4, 45}, 0.001, {0, 0}, 1), 1);  // no margin for the current level
  EXPECT_EQ(level({4, 4, 40}, 0.001, {0, 0}, 1), 0);
  // Tiles at the far end of the block may be coarser.
  EXPECT_EQ(level({0, 4, 11}, 0.003, {0, 0}), 0);
  EXPECT_EQ(level({0, 4, 11}, 0.003, {9, 0}), 2);
}

}  // namespace
}  // namespace kerf::tile_detail_test
