// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/mesh_stock.h"

#include "kernel/dexel/dexel_field.h"
#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::mesh_stock_test {
namespace {

TriangleMesh box_mesh(Vec3 low, Vec3 high) {
  TriangleMesh mesh;
  for (int n = 0; n < 8; ++n) {
    mesh.vertices_mm.push_back(
        {n & 1 ? high.x : low.x, n & 2 ? high.y : low.y, n & 4 ? high.z : low.z});
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TriangleMesh octahedron(Vec3 center, double r) {
  TriangleMesh mesh;
  for (const Vec3 d : {Vec3{r, 0, 0}, Vec3{-r, 0, 0}, Vec3{0, r, 0}, Vec3{0, -r, 0}, Vec3{0, 0, r},
                       Vec3{0, 0, -r}}) {
    mesh.vertices_mm.push_back(center + d);
  }
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return mesh;
}

void append(TriangleMesh& to, const TriangleMesh& from, bool turned = false) {
  const auto first = static_cast<std::uint32_t>(to.vertices_mm.size());
  to.vertices_mm.insert(to.vertices_mm.end(), from.vertices_mm.begin(), from.vertices_mm.end());
  for (auto t : from.triangles) {
    if (turned) std::swap(t[0], t[1]);
    to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
}

/// Returns the winding number by its definition, the sum of solid angles (A. van Oosterom and
/// J. Strackee, The Solid Angle of a Plane Triangle, 1983).
double winding(const TriangleMesh& mesh, Vec3 p) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices_mm[t[0]] - p, b = mesh.vertices_mm[t[1]] - p,
               c = mesh.vertices_mm[t[2]] - p;
    const double la = length(a), lb = length(b), lc = length(c);
    sum += 2 * std::atan2(dot(a, cross(b, c)),
                          la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

TriangleMesh random_bodies(unsigned seed) {
  std::mt19937 random(seed);
  TriangleMesh mesh;
  for (int n = 0; n < 6; ++n) {
    const Vec3 at{uniform(random, 0, 20), uniform(random, 0, 20), uniform(random, 0, 10)};
    TriangleMesh body =
        n % 2 == 0 ? octahedron(at, uniform(random, 2, 6))
                   : box_mesh(at, at + Vec3{uniform(random, 1, 6), uniform(random, 1, 6), 3});
    append(mesh, body, n == 5);
  }
  return mesh;
}

Sculpture sculpture_of(const TriangleMesh& mesh, double pitch_mm, Rays rays = Rays::kDexel) {
  auto made = Sculpture::create({.stock_mesh = std::make_shared<const TriangleMesh>(mesh),
                                 .rays = rays,
                                 .pitch_mm = pitch_mm});
  EXPECT_TRUE(made) << made.error().reason;
  return *std::move(made);
}

void expect_solid_where_winding_is_not_zero(const TriangleMesh& mesh, double pitch_mm,
                                            unsigned seed) {
  std::mt19937 random(seed);
  for (const RayAxis axis : {RayAxis::kX, RayAxis::kY, RayAxis::kZ}) {
    DexelField field(mesh, pitch_mm, axis, true);
    const DexelSnapshot snapshot = field.snapshot();
    const DexelGrid& grid = snapshot.grid();
    std::vector<Dexel> scratch;
    for (int n = 0; n < 400; ++n) {
      const auto i = static_cast<std::int32_t>(random() % std::uint32_t(grid.columns_x));
      const auto j = static_cast<std::int32_t>(random() % std::uint32_t(grid.columns_y));
      const auto depth = static_cast<std::int32_t>(random() % std::uint32_t(grid.height_quanta));
      bool solid = false;
      std::int32_t below = -1;
      for (const Dexel& d : snapshot.column(i, j, scratch)) {
        EXPECT_LT(below, d.bottom);
        EXPECT_LT(d.bottom, d.top);
        below = d.top;
        solid = solid || (d.bottom <= depth && depth < d.top);
      }
      const Vec3 p = from_frame(axis, {grid.x_mm(i), grid.y_mm(j), grid.z_mm(depth)});
      const double w = std::abs(winding(mesh, p));
      // On the surface the sum is midway between two integers.
      if (std::abs(w - std::round(w)) > 0.01) continue;
      EXPECT_EQ(solid, w > 0.5) << p.x << " " << p.y << " " << p.z << " axis " << int(axis);
    }
  }
}

TEST(MeshStock, BoxMeshEqualsBoxStock) {
  // A box with rays on the diagonals of its faces, and one in general position.
  for (const Vec3 high : {Vec3{16, 16, 16}, Vec3{13.7, 9.2, 5.1}}) {
    for (const double pitch : {0.5, 0.37}) {
      for (const RayAxis axis : {RayAxis::kX, RayAxis::kY, RayAxis::kZ}) {
        DexelField mesh(box_mesh({0, 0, 0}, high), pitch, axis, false);
        DexelField box(StockShape(BoxStock{{0, 0, 0}, high}), pitch, axis);
        EXPECT_EQ(mesh.snapshot().hash(), box.snapshot().hash());
        EXPECT_EQ(mesh.stock_volume_mm3(), box.stock_volume_mm3());
        EXPECT_FALSE(mesh.snapshot().touched({0, 0}));  // fully solid: not stored
      }
    }
  }
}

TEST(MeshStock, RaysThroughVerticesAndEdgesAreConsistent) {
  // The octahedra have vertices on rays and edges along rows and diagonals of rays.
  TriangleMesh mesh = box_mesh({-0.5, -0.5, 0}, {20.5, 20.5, 1});
  for (int n = 0; n < 4; ++n) append(mesh, octahedron({5.0 * n + 2, 10, 5}, 2 + n % 2));
  append(mesh, octahedron({10, 4, 4}, 3));
  append(mesh, octahedron({10, 10, 8}, 1));
  expect_solid_where_winding_is_not_zero(mesh, 1, 3);
  expect_solid_where_winding_is_not_zero(mesh, 0.5, 4);
}

TEST(MeshStock, MatchesWindingNumber) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    expect_solid_where_winding_is_not_zero(random_bodies(seed), 0.31, seed);
  }
}

TEST(MeshStock, CavityIsEmptyAndInvertedMeshIsSolid) {
  TriangleMesh hollow = box_mesh({0, 0, 0}, {10, 10, 10});
  append(hollow, box_mesh({3, 3, 3}, {7, 7, 7}), true);
  EXPECT_NEAR(sculpture_of(hollow, 0.5).stock_volume_mm3(), 1000 - 64, 1e-3);
  TriangleMesh turned;
  append(turned, box_mesh({0, 0, 0}, {10, 10, 10}), true);
  EXPECT_NEAR(sculpture_of(turned, 0.5).stock_volume_mm3(), 1000, 1e-3);
  TriangleMesh twice = box_mesh({0, 0, 0}, {10, 10, 10});
  append(twice, box_mesh({5, 0, 0}, {15, 10, 10}));
  EXPECT_NEAR(sculpture_of(twice, 0.5).stock_volume_mm3(), 1500, 1e-3);
}

TEST(MeshStock, AllFieldsRepresentTheSameSolid) {
  const TriangleMesh mesh = octahedron({7, 8, 9}, 6);
  Sculpture sculpture = sculpture_of(mesh, 0.1, Rays::kTriDexel);
  const double exact = 4.0 / 3 * 6 * 6 * 6;
  for (const RayAxis axis : {RayAxis::kX, RayAxis::kY, RayAxis::kZ}) {
    EXPECT_NEAR(sculpture.snapshot(axis).volume_mm3(), exact, 0.001 * exact);
  }
  EXPECT_NEAR(sculpture.stock_volume_mm3(), exact, 0.001 * exact);
}

TEST(MeshStock, CutsLikeABox) {
  Sculpture mesh = sculpture_of(box_mesh({0, 0, 0}, {20, 20, 10}), 0.25);
  Sculpture box =
      *Sculpture::create({.stock = BoxStock{{0, 0, 0}, {20, 20, 10}}, .pitch_mm = 0.25});
  for (Sculpture* s : {&mesh, &box}) {
    ASSERT_TRUE(s->apply(DefineTool{1, make_tool(BallShape{6, 40}).value()}));
    ASSERT_TRUE(s->apply(MoveTool{1, {{3, 3, 7}}, {{17, 12, 5}}, 1, true}));
  }
  EXPECT_EQ(mesh.state_hash(), box.state_hash());
  EXPECT_EQ(mesh.removed_volume_mm3(), box.removed_volume_mm3());
}

TEST(MeshStock, EqualMeshesGiveEqualBytes) {
  const TriangleMesh mesh = random_bodies(5);
  const std::uint64_t hash = sculpture_of(mesh, 0.25, Rays::kTriDexel).state_hash();
  EXPECT_EQ(hash, sculpture_of(mesh, 0.25, Rays::kTriDexel).state_hash());
  EXPECT_NE(hash, sculpture_of(random_bodies(6), 0.25, Rays::kTriDexel).state_hash());
  EXPECT_EQ(sculpture_of(octahedron({0, 0, 0}, 10), 0.3).state_hash(), 15499164828837585164U);
}

TEST(MeshStock, NormalsAreThoseOfTheTriangles) {
  DexelField field(octahedron({0, 0, 0}, 8), 0.5, RayAxis::kZ, true);
  const DexelSnapshot snapshot = field.snapshot();
  const DexelGrid& grid = snapshot.grid();
  for (const std::int32_t i : {3, 11, 20, 28}) {
    const ColumnView column = snapshot.view(i, 13);
    const Vec3 top = snapshot.normal(i, 13, column.topmost.top, true, column.topmost_codes.top);
    const Vec3 bottom =
        snapshot.normal(i, 13, column.topmost.bottom, false, column.topmost_codes.bottom);
    const double side = grid.x_mm(i) < 0 ? -1 : 1;
    const Vec3 expected = normalized({side, -1, 1});
    EXPECT_NEAR(length(top - expected), 0, 1e-3);
    EXPECT_NEAR(length(bottom - Vec3{expected.x, expected.y, -expected.z}), 0, 1e-3);
  }
}

TEST(MeshStock, OpenMeshIsRejectedWithCountsAndPosition) {
  const auto rejection = [](const TriangleMesh& mesh) {
    const auto made = Sculpture::create({.stock_mesh = std::make_shared<const TriangleMesh>(mesh)});
    EXPECT_FALSE(made);
    if (made) return std::string();
    EXPECT_EQ(made.error().code, SculptureErrorCode::kBadStock);
    return made.error().reason;
  };
  TriangleMesh mesh = box_mesh({0, 0, 0}, {1, 2, 3});
  mesh.triangles.pop_back();
  EXPECT_NE(rejection(mesh).find("3 open edges, 0 edges between"), std::string::npos)
      << rejection(mesh);
  EXPECT_NE(rejection(mesh).find("(1.000000, 0.000000, 3.000000)"), std::string::npos)
      << rejection(mesh);
  mesh = box_mesh({0, 0, 0}, {1, 2, 3});
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  EXPECT_NE(rejection(mesh).find("0 open edges, 3 edges between"), std::string::npos)
      << rejection(mesh);
  mesh = box_mesh({0, 0, 0}, {1, 2, std::numeric_limits<double>::quiet_NaN()});
  EXPECT_NE(rejection(mesh).find("not finite"), std::string::npos);
  mesh = box_mesh({0, 0, 0}, {1, 2, 3});
  mesh.triangles[3][1] = 8;
  EXPECT_NE(rejection(mesh).find("vertex that the mesh does not have"), std::string::npos);
  EXPECT_NE(rejection({}).find("no triangle"), std::string::npos);
  EXPECT_NE(rejection(box_mesh({0, 0, 0}, {1, 1, 2e6})).find("within 1e6 mm"), std::string::npos);
  EXPECT_NE(rejection(box_mesh({0, 0, 0}, {1, 1, 0})).find("empty"), std::string::npos);
}

TEST(MeshStock, AStopEndsTheConversionAfterTheRowOfTiles) {
  const TriangleMesh mesh = octahedron({0, 0, 0}, 10);
  const DexelGrid grid = make_grid(mesh_bounds(mesh), 0.1);
  ASSERT_GT(grid.tiles_y(), 2);
  bool is_asked = false;
  std::set<std::int32_t> rows;
  const auto put = [&](TileIndex at, const std::shared_ptr<DexelTile>&) {
    rows.insert(at.y);
    is_asked = true;
  };
  dexelize(mesh, grid, false, put, nullptr, [&] { return is_asked; });
  EXPECT_EQ(rows.size(), 1U);
  const auto made =
      Sculpture::create({.stock_mesh = std::make_shared<const TriangleMesh>(mesh), .pitch_mm = 0.1},
                        [] { return true; });
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, SculptureErrorCode::kStopped);
}

}  // namespace
}  // namespace kerf::mesh_stock_test
