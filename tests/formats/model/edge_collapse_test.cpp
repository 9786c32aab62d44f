// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/edge_collapse.h"

#include "kernel/math/nearest_on_triangle.h"
#include "server/formats/model/mesh_crossings.h"
#include "tests/formats/model/carved_mesh.h"
#include "tests/support/test.h"

namespace kerf::edge_collapse_test {
namespace {

using test::carved_mesh;

IndexedMesh collapsed(const IndexedMesh& mesh, const std::vector<bool>& kept,
                      const CollapseLimits& limits, const std::stop_token& stop = {}) {
  return {mesh.origin_mm, mesh.positions_mm,
          collapse_edges(mesh, MeshNearest(mesh), kept, limits, stop)};
}

// Two triangles back to back enclose no volume, although each edge has two sides.
bool has_two_of_equal_corners(const IndexedMesh& mesh) {
  auto triangles = mesh.triangles;
  for (auto& t : triangles) std::ranges::sort(t);
  std::ranges::sort(triangles);
  return std::ranges::adjacent_find(triangles) != triangles.end();
}

TEST(EdgeCollapse, ATetrahedronStays) {
  const IndexedMesh mesh{{},
                         {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0.5F, 0.5F, 3}},
                         {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  EXPECT_EQ(collapsed(mesh, std::vector<bool>(4, false), {.triangles = 0}).triangles.size(), 4U);
}

TEST(EdgeCollapse, StaysAClosedManifoldDownToFewTriangles) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const IndexedMesh mesh = carved_mesh(seed);
    const std::vector<bool> free(mesh.positions_mm.size(), false);
    for (const std::size_t triangles : {mesh.triangles.size() / 3, std::size_t{40}}) {
      const IndexedMesh result = collapsed(mesh, free, {.triangles = triangles});
      EXPECT_TRUE(check_edges(result.triangles).closed_manifold()) << seed;
      EXPECT_FALSE(has_two_of_equal_corners(result)) << seed;
      EXPECT_LE(result.triangles.size(), std::max<std::size_t>(triangles, 200)) << seed;
    }
  }
}

// Compared with the distance by definition: no vertex is farther from the result than the limit.
TEST(EdgeCollapse, NoVertexLeavesTheResultByMoreThanTheLimit) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const IndexedMesh mesh = carved_mesh(seed);
    for (const double limit_mm : {0.3, 0.03}) {
      const IndexedMesh result =
          collapsed(mesh, std::vector<bool>(mesh.positions_mm.size(), false), {0, limit_mm});
      EXPECT_LT(result.triangles.size(), mesh.triangles.size() / 2);
      double greatest = 0;
      std::mt19937 random(seed);
      for (int n = 0; n < 200; ++n) {
        const auto v = static_cast<std::uint32_t>(random() % mesh.positions_mm.size());
        double nearest = 1e9;
        for (std::size_t t = 0; t < result.triangles.size(); ++t) {
          const Vec3 p = mesh.position(v);
          nearest = std::min(nearest, length(p - nearest_on_triangle(result.corners(t), p).point));
        }
        greatest = std::max(greatest, nearest);
      }
      EXPECT_LE(greatest, limit_mm * (1 + 1e-9)) << seed;
      EXPECT_GT(greatest, limit_mm / 10) << seed;
    }
  }
}

TEST(EdgeCollapse, FixedVerticesStay) {
  const IndexedMesh mesh = carved_mesh(7);
  std::vector<bool> kept(mesh.positions_mm.size(), false);
  for (std::size_t v = 0; v < kept.size(); v += 5) kept[v] = true;
  const IndexedMesh result = collapsed(mesh, kept, {.triangles = 4});
  std::vector<bool> used(kept.size(), false);
  for (const auto& t : result.triangles)
    for (const std::uint32_t v : t) used[v] = true;
  for (std::size_t v = 0; v < kept.size(); ++v) EXPECT_TRUE(used[v] || !kept[v]) << v;
  EXPECT_TRUE(check_edges(result.triangles).closed_manifold());
  EXPECT_LT(result.triangles.size(), mesh.triangles.size() / 2);
}

// A surface of grooves that open the sides of their block. At the sharp edges there, triangles
// could turn onto the side, and edges could leave the surface between vertices that are near it.
TEST(EdgeCollapse, ResultIsNearAndNotFoldedAtSharpEdges) {
  Sculpture sculpture = test::make_sculpture(BoxStock{{0, 0, -20}, {40, 40, 0}}, 0.2);
  ASSERT_TRUE(sculpture.apply(DefineTool{1, *make_tool(BallShape{10, 40})}));
  for (double y = 2; y < 39; y += 1.5)
    for (int x = 2; x < 38; ++x) {
      const auto depth = [&](int at) { return -5 - 3 * std::sin(at / 9.0) * std::cos(y / 11); };
      const MoveTool move{1, {{double(x), y, depth(x)}}, {{x + 1.0, y, depth(x + 1)}}, 0.1};
      ASSERT_TRUE(sculpture.apply(move));
    }
  SnapshotMesh source(sculpture.solid());
  const IndexedMesh mesh = collect_mesh(source);
  const MeshNearest nearest(mesh);
  for (const double limit_mm : {0.02, 0.05, 0.2}) {
    const IndexedMesh result =
        collapsed(mesh, std::vector<bool>(mesh.positions_mm.size(), false), {0, limit_mm});
    EXPECT_LT(result.triangles.size(), mesh.triangles.size() / 10);
    EXPECT_EQ(crossing_triangles(result).size(), 0U) << limit_mm;
    double greatest_mm = 0;
    for (std::size_t t = 0; t < result.triangles.size(); ++t) {
      const auto [a, b, c] = result.corners(t);
      for (const Vec3 p : {(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5})
        greatest_mm = std::max(greatest_mm, std::sqrt(nearest.find(p, 0, 0).squared_mm2));
    }
    EXPECT_LE(greatest_mm, 1.2 * limit_mm);
  }
}

TEST(EdgeCollapse, EndsWhenAStopIsRequested) {
  const IndexedMesh mesh = carved_mesh(3);
  std::stop_source stop;
  stop.request_stop();
  const IndexedMesh result = collapsed(mesh, std::vector<bool>(mesh.positions_mm.size(), false),
                                       {.triangles = 4}, stop.get_token());
  EXPECT_EQ(result.triangles, mesh.triangles);
}

}  // namespace
}  // namespace kerf::edge_collapse_test
