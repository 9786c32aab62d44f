// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/repair_mesh.h"

#include "kernel/dexel/mesh_stock.h"
#include "kernel/sculpture.h"
#include "server/formats/model/mesh_placement.h"
#include "tests/support/test.h"

namespace kerf::repair_mesh_test {
namespace {

using testing::HasSubstr;

void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_mm.size());
  mesh.vertices_mm.insert(mesh.vertices_mm.end(), other.vertices_mm.begin(),
                          other.vertices_mm.end());
  for (const auto& t : other.triangles)
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

/// Twelve triangles, two for each face: -z, +z, -y, +x, +y, -x.
TriangleMesh box(Vec3 min, Vec3 max) {
  TriangleMesh mesh;
  for (unsigned n = 0; n < 8; ++n)
    mesh.vertices_mm.push_back(
        {n & 1U ? max.x : min.x, n & 2U ? max.y : min.y, n & 4U ? max.z : min.z});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {1, 3, 7}, {1, 7, 5}, {3, 2, 6}, {3, 6, 7}, {2, 0, 4}, {2, 4, 6}};
  return mesh;
}

/// A ball of quadrilaterals, split: convex, smooth, many triangles.
TriangleMesh ball(Vec3 center, double radius_mm, unsigned rings) {
  TriangleMesh mesh;
  const unsigned around = 2 * rings;
  mesh.vertices_mm.push_back(center + Vec3{0, 0, -radius_mm});
  for (unsigned r = 1; r < rings; ++r) {
    for (unsigned a = 0; a < around; ++a) {
      const double low = std::numbers::pi * r / rings, turn = 2 * std::numbers::pi * a / around;
      mesh.vertices_mm.push_back(center + radius_mm * Vec3{std::sin(low) * std::cos(turn),
                                                           std::sin(low) * std::sin(turn),
                                                           -std::cos(low)});
    }
  }
  const auto top = static_cast<std::uint32_t>(mesh.vertices_mm.size());
  mesh.vertices_mm.push_back(center + Vec3{0, 0, radius_mm});
  const auto at = [&](unsigned r, unsigned a) { return 1 + (r - 1) * around + a % around; };
  for (unsigned a = 0; a < around; ++a) {
    mesh.triangles.push_back({0, at(1, a + 1), at(1, a)});
    for (unsigned r = 1; r + 1 < rings; ++r) {
      mesh.triangles.push_back({at(r, a), at(r, a + 1), at(r + 1, a + 1)});
      mesh.triangles.push_back({at(r, a), at(r + 1, a + 1), at(r + 1, a)});
    }
    mesh.triangles.push_back({at(rings - 1, a), at(rings - 1, a + 1), top});
  }
  return mesh;
}

double volume_mm3(const TriangleMesh& mesh) {
  EXPECT_EQ(mesh_stock_fault(mesh), "");
  const auto sculpture =
      Sculpture::create({.stock = mesh_bounds(mesh),
                         .stock_mesh = std::make_shared<const TriangleMesh>(mesh),
                         .pitch_mm = 0.25});
  EXPECT_TRUE(sculpture);
  return sculpture ? sculpture->stock_volume_mm3() : 0;
}

MeshRepair repaired(TriangleMesh& mesh) {
  const auto repair = repair_mesh(mesh);
  EXPECT_TRUE(repair) << repair.error();
  return repair.value_or(MeshRepair{});
}

TEST(RepairMesh, LeavesAClosedMeshUnchanged) {
  // Inside out and nested, as the winding rule of stocks accepts them.
  TriangleMesh mesh = box({0, 0, 0}, {10, 10, 10});
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  append(mesh, box({2, 2, 2}, {4, 4, 4}));
  const TriangleMesh before = mesh;
  EXPECT_EQ(repaired(mesh), MeshRepair{});
  EXPECT_EQ(mesh, before);
  EXPECT_EQ(to_string(MeshRepair{}), "");
}

TEST(RepairMesh, ClosesAFlatHoleOfAnyShapeWithItsFlatFace) {
  TriangleMesh open = box({0, 0, 0}, {10, 20, 5});
  open.triangles.erase(open.triangles.begin() + 2, open.triangles.begin() + 4);  // the top
  const MeshRepair one = repaired(open);
  EXPECT_EQ(one.holes_closed, 1U);
  EXPECT_NEAR(one.longest_hole_mm, 60, 1e-9);
  EXPECT_NEAR(volume_mm3(open), 1000, 1e-6);

  // An L whose notch contains the mean point of its outline or not: the fan overlaps itself.
  for (const double arm : {2.0, 9.0}) {
    const Vec3 outline[] = {{0, 0, 0},     {20, 0, 0},   {20, arm, 0},
                            {arm, arm, 0}, {arm, 20, 0}, {0, 20, 0}};
    TriangleMesh ell;
    for (const double z : {0.0, 5.0})
      for (const Vec3& v : outline) ell.vertices_mm.push_back(v + Vec3{0, 0, z});
    for (std::uint32_t n = 0; n < 6; ++n) {
      const std::uint32_t m = (n + 1) % 6;
      ell.triangles.push_back({n, m, m + 6});
      ell.triangles.push_back({n, m + 6, n + 6});
    }
    const MeshRepair both = repaired(ell);
    EXPECT_EQ(both.holes_closed, 2U);
    EXPECT_NEAR(volume_mm3(ell), 5 * (400 - (20 - arm) * (20 - arm)), 1e-6) << arm;
  }
}

/// The rules restore a damaged ball step by step.
TEST(RepairMesh, RestoresADamagedBall) {
  const TriangleMesh whole = ball({1, 2, 3}, 8, 12);
  const double expected_mm3 = volume_mm3(whole);
  for (unsigned seed = 1; seed <= 40; ++seed) {
    std::mt19937 random(seed);
    TriangleMesh mesh;
    std::size_t turned = 0, lost = 0, doubled = 0;
    std::vector<bool> touched(whole.vertices_mm.size());
    for (const auto& t : whole.triangles) {
      const auto fate = static_cast<unsigned>(random() % 20);
      const bool near = touched[t[0]] || touched[t[1]] || touched[t[2]];
      if (fate == 0 && !near) {  // no other hole nearby: the same triangle comes back
        for (const std::uint32_t v : t) touched[v] = true;
        ++lost;
        continue;
      }
      mesh.triangles.push_back(t);
      if (fate < 5) {
        std::swap(mesh.triangles.back()[1], mesh.triangles.back()[2]);
        ++turned;
      } else if (fate < 7) {
        mesh.triangles.push_back({t[1], t[2], t[0]});
        ++doubled;
      }
    }
    mesh.vertices_mm = whole.vertices_mm;
    std::ranges::shuffle(mesh.triangles, random);
    const MeshRepair repair = repaired(mesh);
    EXPECT_EQ(repair.holes_closed, lost) << seed;
    EXPECT_EQ(repair.triangles_turned, turned) << seed;
    EXPECT_EQ(repair.triangles_dropped, doubled) << seed;
    EXPECT_EQ(volume_mm3(mesh), expected_mm3) << seed;
  }
}

TEST(RepairMesh, JoinsSeparatedSeamVertices) {
  // Each triangle has its own corners, moved by less than 1e-5 of the diagonal.
  const TriangleMesh whole = ball({0, 0, 0}, 10, 10);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> apart(-2e-5, 2e-5);
  TriangleMesh mesh;
  for (const auto& t : whole.triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices_mm.size());
    for (const std::uint32_t v : t)
      mesh.vertices_mm.push_back(whole.vertices_mm[v] +
                                 Vec3{apart(random), apart(random), apart(random)});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  const MeshRepair repair = repaired(mesh);
  EXPECT_EQ(repair.holes_closed, 0U);
  EXPECT_EQ(repair.vertices_joined, mesh.vertices_mm.size() - whole.vertices_mm.size());
  EXPECT_NEAR(volume_mm3(mesh), volume_mm3(whole), 0.05);
}

TEST(RepairMesh, KeepsCavitiesAndInvertsShellsInsideOut) {
  const auto damaged = [](TriangleMesh inner, bool turned) {
    if (turned)
      for (auto& t : inner.triangles) std::swap(t[1], t[2]);
    TriangleMesh mesh = box({0, 0, 0}, {10, 10, 10});
    mesh.triangles.erase(mesh.triangles.begin());
    append(mesh, inner);
    return mesh;
  };
  TriangleMesh cavity = damaged(box({2, 2, 2}, {4, 4, 4}), true);
  EXPECT_EQ(repaired(cavity).shells_turned, 0U);
  EXPECT_NEAR(volume_mm3(cavity), 1000 - 8, 1e-6);
  TriangleMesh united = damaged(box({2, 2, 2}, {4, 4, 4}), false);
  EXPECT_EQ(repaired(united).shells_turned, 0U);
  EXPECT_NEAR(volume_mm3(united), 1000, 1e-6);
  TriangleMesh beside = damaged(box({20, 0, 0}, {22, 2, 2}), true);
  const MeshRepair repair = repaired(beside);
  EXPECT_EQ(repair.shells_turned, 1U);
  EXPECT_NEAR(volume_mm3(beside), 1000 + 8, 1e-6);
  EXPECT_EQ(to_string(repair),
            "closed 1 hole (the longest boundary: 34.1 mm), turned 1 shell inside out");
  // A body that overlaps another: inside out it would cancel the common part.
  TriangleMesh across = damaged(box({8, 2, 2}, {12, 4, 4}), true);
  EXPECT_EQ(repaired(across).shells_turned, 1U);
  EXPECT_NEAR(volume_mm3(across), 1000 + 8, 1e-6);
}

TEST(RepairMesh, RejectsMeshesThatBoundNoSolid) {
  TriangleMesh sheet;
  sheet.vertices_mm = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  const TriangleMesh before = sheet;
  EXPECT_THAT(repair_mesh(sheet).error(), HasSubstr("encloses no volume"));
  EXPECT_EQ(sheet, before);

  TriangleMesh strip;  // Moebius: five quadrilaterals around, the last one joined with a twist
  for (int n = 0; n < 5; ++n) {
    const double turn = 2 * std::numbers::pi * n / 5;
    for (const double side : {-1.0, 1.0}) {
      const double out = 5 + side * std::cos(turn / 2);
      strip.vertices_mm.push_back(
          {out * std::cos(turn), out * std::sin(turn), side * std::sin(turn / 2)});
    }
  }
  for (std::uint32_t n = 0; n < 5; ++n) {
    const std::uint32_t a = 2 * n, b = a + 1, c = n == 4 ? 1 : a + 2, d = n == 4 ? 0 : a + 3;
    strip.triangles.push_back({a, b, d});
    strip.triangles.push_back({a, d, c});
  }
  EXPECT_THAT(repair_mesh(strip).error(), HasSubstr("one side only"));
}

TEST(PlaceMesh, ScalesThenTurnsThenMoves) {
  TriangleMesh mesh{.vertices_mm = {{1, 2, 3}}};
  place_mesh(mesh, {.unit_mm = 25.4,
                    .scale = {1, 2, 1},
                    .rotate_deg = {90, 0, -90},
                    .translate_mm = {100, 0, 0}});
  // (25.4, 101.6, 76.2) about x: (25.4, -76.2, 101.6); about z: (-76.2, -25.4, 101.6).
  EXPECT_EQ(mesh.vertices_mm[0], (Vec3{100 - 3 * 25.4, -25.4, 4 * 25.4}));
  mesh.vertices_mm = {{2, 0, 0}};
  place_mesh(mesh,
             {.unit_mm = 1, .scale = {1, 1, 1}, .rotate_deg = {0, 30, 0}, .translate_mm = {}});
  EXPECT_NEAR(mesh.vertices_mm[0].x, std::sqrt(3), 1e-15);
  EXPECT_NEAR(mesh.vertices_mm[0].z, -1, 1e-15);
}

}  // namespace
}  // namespace kerf::repair_mesh_test
