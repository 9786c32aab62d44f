// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/simplify_mesh.h"

#include "server/formats/model/mesh_distance.h"
#include "tests/formats/model/carved_mesh.h"
#include "tests/support/self_intersection.h"
#include "tests/support/test.h"

namespace kerf::simplify_mesh_test {
namespace {

using test::carved_block;
using test::carved_mesh;

std::expected<SimplifiedMesh, ModelError> simplified(unsigned seed,
                                                     const SimplifyRequest& request) {
  SnapshotMesh mesh(carved_block(seed));
  return simplify_mesh(mesh, request);
}

double volume(const IndexedMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    sum += dot(a, cross(b, c)) / 6;
  }
  return sum;
}

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

/// The distance of a point from a mesh by definition: for every triangle, to its plane if the
/// point's foot is inside, else to the three edges.
double brute_distance(const IndexedMesh& mesh, Vec3 point_mm) {
  const Vec3 q = point_mm - mesh.origin_mm;
  double nearest = 1e9;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    const Vec3 normal = normalized(cross(b - a, c - a));
    const Vec3 foot = q - normal * dot(q - a, normal);
    const auto left = [&](Vec3 from, Vec3 to) {
      return dot(cross(to - from, foot - from), normal) >= 0;
    };
    const auto edge = [&](Vec3 from, Vec3 to) {
      const Vec3 d = to - from;
      return length(q - from - d * std::clamp(dot(q - from, d) / dot(d, d), 0.0, 1.0));
    };
    const bool inside = left(a, b) && left(b, c) && left(c, a);
    nearest = std::min(nearest,
                       inside ? length(q - foot) : std::min({edge(a, b), edge(b, c), edge(c, a)}));
  }
  return nearest;
}

/// The greatest distance of the vertices of one mesh from another mesh.
double greatest_distance(const IndexedMesh& from, const IndexedMesh& to, std::mt19937& random) {
  double greatest = 0;
  for (int n = 0; n < 100; ++n) {
    const auto vertex = static_cast<std::uint32_t>(random() % from.positions_mm.size());
    greatest = std::max(greatest, brute_distance(to, from.position(vertex) + from.origin_mm));
  }
  return greatest;
}

/// Counts with predicates that share no code with the simplification.
std::size_t count_crossing(const IndexedMesh& mesh) {
  TileMesh all{.positions_mm = mesh.positions_mm};
  for (const auto& t : mesh.triangles) all.indices.insert(all.indices.end(), t.begin(), t.end());
  const auto found = test::count_self_intersections({all}, 1);
  return found.crossed + found.zero_area;
}

TEST(CheckEdges, CountsOpenAndRepeatedEdges) {
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;
  const Triangles tetrahedron{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_TRUE(check_edges(tetrahedron).closed_manifold());
  Triangles open = tetrahedron;
  open.pop_back();
  EXPECT_EQ(check_edges(open).open, 3U);
  EXPECT_EQ(check_edges(open).vertices, (std::vector<std::uint32_t>{0, 2, 3}));
  Triangles turned = tetrahedron;
  std::swap(turned[0][0], turned[0][1]);
  EXPECT_EQ(check_edges(turned).open, 3U);
  // Two tetrahedra that share the edge 0-1.
  Triangles two = tetrahedron;
  for (const auto& t : Triangles{{0, 4, 1}, {0, 1, 5}, {1, 4, 5}, {4, 0, 5}}) two.push_back(t);
  EXPECT_EQ(check_edges(two).open, 0U);
  EXPECT_EQ(check_edges(two).repeated, 1U);
}

TEST(SimplifyMesh, KeepsTheBudgetAndStaysAClosedManifold) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const std::size_t all = carved_mesh(seed).triangles.size();
    for (const double share : {0.4, 0.05}) {
      const auto budget = static_cast<std::uint64_t>(share * double(all));
      const auto result = test::value_of(simplified(seed, {.triangles = budget, .error_mm = {}}));
      EXPECT_EQ(result.original_triangles, all);
      EXPECT_LE(result.mesh.triangles.size(), budget);
      EXPECT_GE(result.mesh.triangles.size(), budget * 9 / 10);
      EXPECT_TRUE(check_edges(result.mesh.triangles).closed_manifold()) << seed << " " << share;
      EXPECT_EQ(count_crossing(result.mesh), result.crossing_triangles);
      // A twentieth of the triangles is too few for the thin walls.
      EXPECT_LE(result.crossing_triangles, share < 0.1 ? 12U : 0U) << seed << " " << share;
    }
  }
}

TEST(SimplifyMesh, KeepsTheErrorBoundAndReportsTheError) {
  std::mt19937 random(11);
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const IndexedMesh exact = carved_mesh(seed);
    for (const double bound_mm : {0.3, 0.1}) {
      const auto result = test::value_of(simplified(seed, {.triangles = {}, .error_mm = bound_mm}));
      EXPECT_LE(result.error_mm, bound_mm);
      EXPECT_LT(result.mesh.triangles.size(), exact.triangles.size() * 9 / 10);
      EXPECT_TRUE(check_edges(result.mesh.triangles).closed_manifold());
      EXPECT_EQ(count_crossing(result.mesh), 0U);
      EXPECT_NEAR(volume(result.mesh), volume(exact), 0.05 * volume(exact));
      EXPECT_LE(greatest_distance(exact, result.mesh, random), bound_mm);
      EXPECT_LE(greatest_distance(result.mesh, exact, random), bound_mm);
    }
  }
}

TEST(SimplifyMesh, ReducesABoxToAboutTwelveTriangles) {
  Sculpture sculpture = test::make_sculpture(BoxStock{{0, 0, 0}, {12, 8, 5}}, 0.25);
  SnapshotMesh mesh(sculpture.solid());
  const auto result = test::value_of(simplify_mesh(mesh, {.triangles = {}, .error_mm = 0.01}));
  EXPECT_LE(result.mesh.triangles.size(), 20U);
  EXPECT_NEAR(volume(result.mesh), 12 * 8 * 5, 1e-3);
}

TEST(SimplifyMesh, AcceptsABudgetAboveTheNumberOfTriangles) {
  for (const std::uint64_t triangles : {std::uint64_t{1000}, std::uint64_t{1} << 62}) {
    SnapshotMesh box(test::make_sculpture(BoxStock{{0, 0, 0}, {10, 10, 10}}, 1).solid());
    const auto result =
        test::value_of(simplify_mesh(box, SimplifyRequest{triangles, std::nullopt}));
    EXPECT_LT(result.original_triangles, 1000U);
    EXPECT_GT(result.mesh.triangles.size(), 0U);
  }
}

TEST(SimplifyMesh, ReportsTheTrianglesNeededIfTheBudgetIsTooSmall) {
  const auto error = test::error_of(simplified(1, {.triangles = 2, .error_mm = {}}));
  EXPECT_NE(error.reason.find("more than the 2 requested"), std::string::npos);
  const auto both = test::error_of(simplified(1, {.triangles = 100, .error_mm = 0.001}));
  EXPECT_NE(both.reason.find("within 0.001 mm"), std::string::npos) << both.reason;
}

TEST(WholeMesh, ReturnsEveryTriangleWithSharpNormalsAtCreases) {
  Sculpture sculpture = test::make_sculpture(BoxStock{{0, 0, 0}, {6, 6, 6}}, 0.5);
  SnapshotMesh source(sculpture.solid());
  const IndexedMesh mesh = collect_mesh(source);
  WholeMesh whole(mesh);
  std::size_t triangles = 0;
  for (MeshPiece piece; whole.next(piece);) {
    triangles += piece.indices.size() / 3;
    for (const auto& n : piece.normals) {
      EXPECT_NEAR(std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]), 1, 1e-6);
    }
  }
  EXPECT_EQ(triangles, mesh.triangles.size());
}

TEST(MeshDistance, MatchesBruteForceOverAllTriangles) {
  const IndexedMesh mesh = carved_mesh(3);
  const MeshDistance distance(mesh);
  const SolidSnapshot snapshot = carved_block(3);
  std::mt19937 random(5);
  std::vector<Dexel> scratch;
  std::uint32_t near = 0;
  for (int n = 0; n < 300; ++n) {
    const Vec3 p{uniform(random, -8, 12), uniform(random, 2, 22), uniform(random, 0, 12)};
    const double nearest = brute_distance(mesh, p);
    const double found = distance.signed_distance_mm(p, near);
    EXPECT_NEAR(std::abs(found), nearest, 1e-9);
    // Far from the surface, the sign is that of the dexels.
    if (nearest < 0.6) continue;
    const DexelGrid& grid = snapshot.grid();
    const auto i = static_cast<std::int32_t>(std::floor((p.x - grid.origin_mm.x) / grid.pitch_mm));
    const auto j = static_cast<std::int32_t>(std::floor((p.y - grid.origin_mm.y) / grid.pitch_mm));
    bool solid = false;
    for (const Dexel& d : snapshot.fields.front().column(i, j, scratch)) {
      solid = solid || (p.z > grid.z_mm(d.bottom) && p.z < grid.z_mm(d.top));
    }
    EXPECT_EQ(found < 0, solid) << p.x << " " << p.y << " " << p.z;
  }
}

}  // namespace
}  // namespace kerf::simplify_mesh_test
