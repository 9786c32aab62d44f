// SPDX-License-Identifier: Apache-2.0
#include "server/carve/deviation.h"

#include <gtest/gtest.h>

#include "tests/support/carvings.h"

namespace kerf {
namespace {

IndexedMesh mesh_of(const SolidSnapshot& snapshot) {
  SnapshotMesh mesh(snapshot);
  return collect_mesh(mesh);
}

SolidSnapshot block(double height_mm) {
  return test::make_sculpture(BoxStock{{0, 0, 0}, {20, 10, height_mm}}, 0.5).solid();
}

TEST(Deviation, IsPositiveWhereMaterialWasLeft) {
  const IndexedMesh lower = mesh_of(block(5)), higher = mesh_of(block(5.5));
  SnapshotMesh surface(block(5.5));
  const Deviation left = measure_deviation(surface, MeshDistance(lower), 0.5);
  EXPECT_NEAR(left.figures.max_mm, 0.5, 1e-6);
  EXPECT_NEAR(left.figures.min_mm, 0, 1e-6);
  SnapshotMesh again(block(5));
  const Deviation taken = measure_deviation(again, MeshDistance(higher), 0.5);
  EXPECT_NEAR(taken.figures.min_mm, -0.5, 1e-6);
  EXPECT_NEAR(taken.figures.max_mm, 0, 1e-6);
}

TEST(Deviation, FiguresAreWeightedByArea) {
  const IndexedMesh lower = mesh_of(block(5));
  SnapshotMesh surface(block(5.5));
  const DistanceFigures d = measure_deviation(surface, MeshDistance(lower), 0.25).figures;
  // The top (20 x 10) is 0.5 off; of the sides (60 x 5.5) the upper 0.5 mm are, by 0 to 0.5.
  const double area = 2 * 200 + 60 * 5.5;
  EXPECT_NEAR(d.mean_mm, (200 * 0.5 + 60 * 0.5 * 0.25) / area, 0.002);
  EXPECT_NEAR(d.rms_mm, std::sqrt((200 * 0.25 + 60 * 0.5 * 0.25 / 3) / area), 0.002);
  EXPECT_NEAR(d.p50_mm, 0, 1e-6);
  EXPECT_NEAR(d.p90_mm, 0.5, 1e-6);
  EXPECT_GT(d.samples, 4000U);
}

TEST(Deviation, ColorsRunFromBlueThroughWhiteToRed) {
  const IndexedMesh lower = mesh_of(block(5));
  const auto source = [] { return std::make_unique<SnapshotMesh>(block(5.5)); };
  const auto measured = source();
  const Deviation deviation = measure_deviation(*measured, MeshDistance(lower), 0.5);
  DeviationMesh colored(source(), deviation, 0.5);
  std::size_t white = 0, red = 0;
  for (MeshPiece piece; colored.next(piece);) {
    ASSERT_EQ(piece.colors.size(), piece.positions_mm.size());
    for (std::size_t n = 0; n < piece.colors.size(); ++n) {
      const auto& [r, g, b] = piece.colors[n];
      if (std::abs(piece.deviations_mm[n]) < 1e-6F) {
        EXPECT_EQ(r, b);
        ++white;
      } else {
        EXPECT_NEAR(double(piece.deviations_mm[n]), 0.5, 1e-6);
        EXPECT_GT(r, b + 100);
        ++red;
      }
    }
  }
  EXPECT_GT(white, 4U);
  EXPECT_GT(red, 4U);
}

TEST(DistanceFigures, MatchTheirDefinitions) {
  const DistanceFigures d = distance_figures({{-4, 1}, {1, 98}, {3, 1}});
  EXPECT_EQ(d.min_mm, -4);
  EXPECT_EQ(d.max_mm, 3);
  EXPECT_DOUBLE_EQ(d.mean_mm, 0.97);
  EXPECT_DOUBLE_EQ(d.rms_mm, std::sqrt(1.23));
  EXPECT_EQ(d.p50_mm, 1);
  EXPECT_EQ(d.p90_mm, 1);
  EXPECT_EQ(d.p99_mm, 4);
  EXPECT_EQ(distance_figures({}).samples, 0U);
}

}  // namespace
}  // namespace kerf
