// SPDX-License-Identifier: Apache-2.0
#include "server/feed/quad_merge.h"

#include "server/feed/tile_border.h"
#include "server/formats/model/mesh_distance.h"
#include "tests/support/carvings.h"
#include "tests/support/mesh_check.h"
#include "tests/support/test.h"

namespace kerf::quad_merge_test {
namespace {

constexpr double kPitchMm = 0.25;
const BoxStock kBlock{{-3, 2, 1}, {28, 28, 9}};

Sculpture block(Rays rays = Rays::kDexel) {
  return std::move(
      Sculpture::create({.stock = kBlock, .rays = rays, .pitch_mm = kPitchMm}).value());
}

Sculpture carved_block(unsigned seed, Rays rays) {
  Sculpture sculpture = block(rays);
  test::RandomCarver carver(sculpture, kBlock.min_mm, kBlock.max_mm, seed);
  for (int n = 0; n < 20; ++n) carver.cut();
  return sculpture;
}

/// A block whose top was milled off by a tool that descends from one side to the other.
Sculpture ramp(const ToolShape& shape) {
  Sculpture sculpture = block();
  sculpture.apply(DefineTool{1, make_tool(shape).value()}).value();
  const Vec3 up{0, 0, 1};
  sculpture.apply(MoveTool{1, {{-10, 15, 9}, up}, {{40, 15, 4}, up}, 1, false}).value();
  return sculpture;
}

std::vector<TileMesh> merged(const std::vector<TileMesh>& exact, const DexelGrid& grid,
                             double error_mm) {
  std::vector<TileMesh> meshes = exact;
  for (TileMesh& mesh : meshes) mesh.indices = merged_quads(mesh, grid, {error_mm, 2});
  return meshes;
}

std::size_t triangles_of(const std::vector<TileMesh>& meshes) {
  return test::check_mesh(meshes).triangles;
}

/// Returns the maximum distance, mm, of a former vertex of a triangle from the present triangles.
double farthest_mm(const TileMesh& exact, const TileMesh& now) {
  IndexedMesh mesh;
  mesh.positions_mm.assign(now.positions_mm.begin(), now.positions_mm.end());
  for (std::size_t t = 0; t < now.indices.size(); t += 3) {
    mesh.triangles.push_back({now.indices[t], now.indices[t + 1], now.indices[t + 2]});
  }
  IndexedMesh before;
  before.positions_mm.assign(exact.positions_mm.begin(), exact.positions_mm.end());
  const MeshDistance distance(mesh);
  double most = 0;
  std::uint32_t near = 0;
  for (const std::uint32_t vertex : std::set(exact.indices.begin(), exact.indices.end())) {
    most = std::max(most, distance.distance_mm(before.position(vertex), near));
  }
  return most;
}

class QuadMergeOfRays : public testing::TestWithParam<Rays> {};

TEST_P(QuadMergeOfRays, BlockStaysClosedAndBordersKeepTheirEdges) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Sculpture sculpture = carved_block(seed, GetParam());
    const DexelGrid& grid = sculpture.grid();
    const auto exact = test::mesh_all(sculpture.solid());
    for (const double error_mm : {0.02, 0.2, 2.0}) {
      const auto meshes = merged(exact, grid, error_mm);
      EXPECT_EQ(test::check_mesh(meshes).open_edges, 0U) << seed << ", " << error_mm;
      for (std::size_t n = 0; n < exact.size(); ++n) {
        EXPECT_TRUE(same_border(exact[n], meshes[n].indices, grid)) << seed << ", tile " << n;
      }
    }
  }
}

TEST_P(QuadMergeOfRays, NoVertexIsFartherFromTheSurfaceThanTheError) {
  std::size_t before = 0, after = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Sculpture sculpture = carved_block(seed, GetParam());
    const auto exact = test::mesh_all(sculpture.solid());
    for (const double error_mm : {0.01, 0.03, 0.1}) {
      const auto meshes = merged(exact, sculpture.grid(), error_mm);
      for (std::size_t n = 0; n < exact.size(); ++n) {
        if (exact[n].indices.empty()) continue;
        EXPECT_LE(farthest_mm(exact[n], meshes[n]), error_mm) << seed << ", tile " << n;
      }
      before += triangles_of(exact);
      after += triangles_of(meshes);
    }
  }
  EXPECT_LT(after, before * 9 / 10);
}

INSTANTIATE_TEST_SUITE_P(, QuadMergeOfRays, testing::Values(Rays::kDexel, Rays::kTriDexel));

TEST(QuadMerge, PlaneThatLeansTakesFewTriangles) {
  Sculpture sculpture = ramp(FlatShape{.diameter_mm = 60, .length_mm = 30});
  const auto exact = test::mesh_all(sculpture.solid());
  const auto meshes = merged(exact, sculpture.grid(), 0.01);
  for (std::size_t n = 0; n < exact.size(); ++n) {
    // Tiles of the first row and column have sides of the block, which stay.
    if (exact[n].tile != TileIndex{1, 1}) continue;
    EXPECT_GT(exact[n].indices.size() / 3, 1700U);
    // A side of 32 quadrangles keeps all vertices. Triangles get larger from there.
    EXPECT_LT(meshes[n].indices.size() / 3, 700U);
  }
}

/// A bowl with ripples, whose surface skips no layer of cells: one vertex in each of its columns.
/// Every other vertex is raised.
TileMesh bowl() {
  constexpr std::uint32_t kSide = kTileSide + 1;
  TileMesh mesh;
  for (std::uint32_t n = 0; n < kSide * kSide; ++n) {
    const std::uint32_t column = n % kSide, row = n / kSide;
    const double x = column - kTileSide / 2.0, y = row - kTileSide / 2.0;
    const double ripple_mm = column % 2 == 1 || row % 2 == 1 ? -0.004 : 0;
    const Vec3 normal = normalized({-x / 2000, -y / 2000, 1});
    mesh.positions_mm.push_back({float(column * kPitchMm), float(row * kPitchMm),
                                 float((x * x + y * y) / 4000 * kPitchMm + ripple_mm)});
    mesh.normals.push_back({float(normal.x), float(normal.y), float(normal.z)});
    mesh.original.push_back(0);
    if (column == kTileSide || row == kTileSide) continue;
    const std::uint32_t up = n + kSide;
    mesh.indices.insert(mesh.indices.end(), {n, n + 1, up + 1, n, up + 1, up});
  }
  return mesh;
}

TEST(QuadMerge, ErrorsOfFinerTrianglesAddUp) {
  const TileMesh exact = bowl();
  const DexelGrid grid = block().grid();
  std::size_t fewest = exact.indices.size();
  for (double error_mm = 0.001; error_mm < 0.05; error_mm *= 1.15) {
    TileMesh mesh = exact;
    mesh.indices = merged_quads(exact, grid, {error_mm, 2});
    // The other half is reserved for vertices joined earlier.
    EXPECT_LE(farthest_mm(exact, mesh), 0.5001 * error_mm);
    fewest = std::min(fewest, mesh.indices.size());
  }
  EXPECT_LT(fewest, exact.indices.size() / 3);
}

TEST(QuadMerge, GreaterErrorsLeaveFewerTriangles) {
  Sculpture sculpture = ramp(BallShape{.diameter_mm = 24, .length_mm = 30});
  const auto exact = test::mesh_all(sculpture.solid());
  std::size_t finer = triangles_of(exact);
  for (const double error_mm : {0.005, 0.02, 0.08}) {
    const std::size_t triangles = triangles_of(merged(exact, sculpture.grid(), error_mm));
    EXPECT_LT(triangles, finer) << error_mm;
    finer = triangles;
  }
}

TEST(QuadMerge, CreasesKeepTheirVertices) {
  Sculpture sculpture = ramp(FlatShape{.diameter_mm = 12, .length_mm = 30});
  std::size_t creases = 0;
  for (const TileMesh& mesh : test::mesh_all(sculpture.solid())) {
    const auto indices = merged_quads(mesh, sculpture.grid(), {0.1, 2});
    const std::set<std::uint32_t> kept(indices.begin(), indices.end());
    std::multiset<std::array<float, 3>> positions;
    for (const std::uint32_t v : std::set(mesh.indices.begin(), mesh.indices.end())) {
      positions.insert(mesh.positions_mm[v]);
    }
    for (const std::uint32_t v : std::set(mesh.indices.begin(), mesh.indices.end())) {
      if (positions.count(mesh.positions_mm[v]) < 2) continue;
      ++creases;
      EXPECT_TRUE(kept.contains(v));
    }
  }
  EXPECT_GT(creases, 100U);
}

TEST(QuadMerge, UntouchedBlockAndErrorOfZeroChangeNothing) {
  Sculpture untouched = block();
  for (const TileMesh& mesh : test::mesh_all(untouched.solid())) {
    EXPECT_EQ(merged_quads(mesh, untouched.grid(), {0.1, 2}).size(), mesh.indices.size());
  }
  EXPECT_TRUE(merged_quads({}, untouched.grid(), {0.1, 2}).empty());
}

}  // namespace
}  // namespace kerf::quad_merge_test
