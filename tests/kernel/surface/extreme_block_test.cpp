// SPDX-License-Identifier: Apache-2.0
// Meshing of blocks whose proportions are extreme: flatter than a pitch, longer than a tile, tiny,
// huge, far from the origin.

#include "tests/support/extreme_block.h"

#include "tests/support/carvings.h"
#include "tests/support/mesh_check.h"
#include "tests/support/test.h"

namespace kerf::extreme_block_test {
namespace {

using test::MeshReport;

void expect_closed(const MeshReport& report) {
  EXPECT_EQ(report.open_edges, 0U);
  EXPECT_EQ(report.repeated_edges, 0U);
  EXPECT_EQ(report.degenerate, 0U);
  EXPECT_EQ(report.bad_normals, 0U);
}

TEST(ExtremeBlock, LowerThanHalfAPitchKeepsItsVolume) {
  // In a block just below half a pitch high, one step of the lattice exceeds 2^30 quanta, in lower
  // ones 2^31.
  for (const double height : {0.5, 0.4999999, 0.3, 0.25, 0.01, 1e-4}) {
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      SCOPED_TRACE(std::to_string(height) + " " + to_string(rays));
      Sculpture sculpture = *Sculpture::create(
          {.stock = BoxStock{{-7, 3, 5}, {73, 33, 5 + 2 * height}}, .rays = rays, .pitch_mm = 2});
      const MeshReport report = test::check_mesh(test::mesh_all(sculpture.solid()));
      expect_closed(report);
      EXPECT_NEAR(report.volume_mm3 / (80 * 30 * 2 * height), 1, 1e-5);
    }
  }
}

TEST(ExtremeBlock, LowCylinderKeepsItsVolume) {
  Sculpture sculpture =
      *Sculpture::create({.stock = CylinderStock{3, -2, 40, 0, 0.2}, .pitch_mm = 1});
  const MeshReport report = test::check_mesh(test::mesh_all(sculpture.solid()));
  expect_closed(report);
  EXPECT_NEAR(report.volume_mm3 / sculpture.solid().fields.front().volume_mm3(), 1, 0.02);
}

TEST(ExtremeBlock, SkinOfOneQuantumIsClosed) {
  Sculpture sculpture = test::make_sculpture(BoxStock{{0, 0, 0}, {20, 20, 10}}, 0.5);
  const double quantum = sculpture.grid().z_quantum_mm;
  ASSERT_TRUE(sculpture.apply(DefineTool{1, make_tool(FlatShape{12, 40}).value()}));
  ASSERT_TRUE(sculpture.apply(MoveTool{1, {{10, 10, quantum}}, {{10, 10, quantum}}, 1, false}));
  ASSERT_EQ(sculpture.solid().fields.front().view(20, 20).topmost, (Dexel{0, 1}));
  const MeshReport report = test::check_mesh(test::mesh_all(sculpture.solid()));
  expect_closed(report);
  EXPECT_NEAR(report.volume_mm3, sculpture.solid().fields.front().volume_mm3(), 30);
}

TEST(ExtremeBlock, RandomProportionsGiveClosedManifolds) {
  std::size_t meshed = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + " " + to_string(rays));
      test::ExtremeBlock block(seed, rays);
      Sculpture sculpture = block.make(int(seed % 4));
      const MeshReport report = test::check_mesh(test::mesh_all(sculpture.solid()));
      expect_closed(report);
      EXPECT_GE(report.volume_mm3, 0);
      meshed += report.triangles > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(meshed, 60U);
}

TEST(ExtremeBlock, SidesBeyondTheResolutionOfFloatsAreRejected) {
  SculptureSettings settings;
  settings.pitch_mm = 0.01;
  settings.stock = BoxStock{{0, 0, 0}, {0.1, 0.1, 0.01 * (1 << 20)}};
  EXPECT_TRUE(Sculpture::create(settings));
  settings.stock = BoxStock{{0, 0, 0}, {0.1, 0.1, 0.01 * ((1 << 20) + 1)}};
  const auto created = Sculpture::create(settings);
  ASSERT_FALSE(created);
  EXPECT_EQ(created.error().code, SculptureErrorCode::kTooManyColumns);
  settings.keep_normals = false;
  EXPECT_TRUE(Sculpture::create(settings));
}

}  // namespace
}  // namespace kerf::extreme_block_test
