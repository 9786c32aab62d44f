// SPDX-License-Identifier: Apache-2.0
#include "server/verify/deviation.h"

#include "server/verify/deviation_survey.h"
#include "tests/support/carvings.h"
#include "tests/support/test.h"

namespace kerf::deviation_test {
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
  // The top (20 x 10) is off by 0.5. On the sides (60 x 5.5) the upper 0.5 mm are off by 0 to 0.5.
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

/// A block 20 x 10 x 5 with two pits of a ball, 1 and 2 mm deep.
SolidSnapshot block_with_pits() {
  Sculpture sculpture = test::make_sculpture(BoxStock{{0, 0, 0}, {20, 10, 5}}, 0.5);
  const Tool ball = make_tool(BallShape{.diameter_mm = 2, .length_mm = 30}).value();
  EXPECT_TRUE(sculpture.apply(DefineTool{1, ball}));
  const Vec3 up{0, 0, 1};
  for (const Vec3 bottom : {Vec3{5, 5, 4}, Vec3{15, 5, 3}}) {
    const MoveTool plunge{1, {bottom + Vec3{0, 0, 4}, up}, {bottom, up}, 1, false};
    EXPECT_TRUE(sculpture.apply(plunge));
  }
  return sculpture.solid();
}

TEST(DeviationSurvey, QuantilesAreSharesOfTheArea) {
  const IndexedMesh lower = mesh_of(block(5));
  SnapshotMesh surface(block(5.5));
  const DeviationSurvey survey = survey_deviation(surface, MeshDistance(lower), 0.25);
  const double area = 2 * 200 + 60 * 5.5;
  EXPECT_NEAR(survey.area_mm2, area, 1e-6 * area);
  ASSERT_EQ(survey.quantiles_mm.size(), kQuantileSteps + 1);
  EXPECT_NEAR(survey.quantiles_mm.front(), 0, 1e-6);
  EXPECT_NEAR(survey.quantiles_mm.back(), 0.5, 1e-6);
  EXPECT_TRUE(std::ranges::is_sorted(survey.quantiles_mm));
  // The bottom and the lower 5 mm of the sides have no deviation.
  const auto beyond =
      std::ranges::count_if(survey.quantiles_mm, [](double mm) { return mm > 1e-3; });
  // Around the block the limit may be off by half a spacing.
  EXPECT_NEAR(static_cast<double>(beyond) / kQuantileSteps, (200 + 60 * 0.5) / area,
              60 * 0.25 / 2 / area);
}

TEST(DeviationSurvey, ListsThePeaksWorstFirst) {
  const IndexedMesh whole = mesh_of(block(5));
  SnapshotMesh surface(block_with_pits());
  const DeviationSurvey survey = survey_deviation(surface, MeshDistance(whole), 0.5);
  ASSERT_GE(survey.worst.size(), 2U);
  EXPECT_LE(survey.worst.size(), kWorstPlacesMax);
  const DeviationPlace &deep = survey.worst[0], &flat = survey.worst[1];
  EXPECT_NEAR(deep.mm, -2, 0.01);
  EXPECT_NEAR(deep.at_mm.x, 15, 0.5);
  EXPECT_NEAR(deep.at_mm.z, 3, 0.01);
  EXPECT_GT(deep.normal.z, 0.9);
  EXPECT_EQ(survey.figures.min_mm, deep.mm);
  EXPECT_NEAR(flat.mm, -1, 0.01);
  EXPECT_NEAR(flat.at_mm.x, 5, 0.5);
  EXPECT_TRUE(std::ranges::is_sorted(survey.worst, std::greater(), [](const DeviationPlace& place) {
    return std::abs(place.mm);
  }));
}

TEST(DeviationSurvey, IsEmptyForAnEmptySurface) {
  const IndexedMesh whole = mesh_of(block(5));
  const IndexedMesh none;
  WholeMesh surface(none);
  const DeviationSurvey survey = survey_deviation(surface, MeshDistance(whole), 0.5);
  EXPECT_TRUE(survey.quantiles_mm.empty());
  EXPECT_TRUE(survey.worst.empty());
  EXPECT_EQ(survey.area_mm2, 0);
  EXPECT_EQ(survey.figures.max_mm, 0);
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
}  // namespace kerf::deviation_test
