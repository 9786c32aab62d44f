// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include "server/formats/model/model_writer.h"
#include "tests/support/carvings.h"
#include "tests/support/test.h"

namespace kerf::coarse_coordinates_test {
namespace {

constexpr const char* kOption = "--model-translate";

SolidSnapshot carved_block(Vec3 moved) {
  const BoxStock block{Vec3{-6, 4, 2} + moved, Vec3{30, 36, 9} + moved};
  Sculpture sculpture = test::make_sculpture(block, 0.4);
  test::RandomCarver carver(sculpture, block.min_mm, block.max_mm, 3);
  for (int n = 0; n < 25; ++n) carver.cut();
  return sculpture.solid();
}

ModelSummary write(const SolidSnapshot& solid, ModelFormat format, Vec3 shift_mm = {}) {
  const auto path =
      std::filesystem::path(::testing::TempDir()) / (std::to_string(::getpid()) + "_coarse");
  SnapshotMesh mesh(solid);
  const auto written = write_model(
      path, mesh,
      {.format = format, .encoding = model_encodings(format).front(), .shift_mm = shift_mm});
  EXPECT_TRUE(written);
  std::filesystem::remove(path);
  return written.value_or(ModelSummary{});
}

std::string warning(const SolidSnapshot& solid, const ModelSummary& summary) {
  return coarse_coordinates(summary, solid.grid().pitch_mm, solid.grid().origin_mm,
                            SnapshotMesh(solid).size_mm(), kOption);
}

TEST(CoarseCoordinates, ReportTheStepAndTheShiftThatAvoidsThem) {
  const SolidSnapshot there = carved_block({990'000, -990'000, 0});
  for (const ModelFormat format :
       {ModelFormat::kStl, ModelFormat::kPly, ModelFormat::kObj, ModelFormat::k3mf}) {
    const ModelSummary coarse = write(there, format);
    EXPECT_GT(coarse.collapsed, 0U);
    const std::string text = warning(there, coarse);
    EXPECT_TRUE(text.starts_with(std::to_string(coarse.collapsed) + " of ")) << text;
    EXPECT_NE(text.find("0.0625 mm apart"), text.npos) << text;
    EXPECT_NE(text.find("--model-translate -989994,989996,-2 moves"), text.npos) << text;
    const ModelSummary shifted = write(there, format, {-989'994, 989'996, -2});
    EXPECT_EQ(warning(there, shifted), "");
    EXPECT_LT(shifted.collapsed, coarse.collapsed / 10 + 1);
  }
}

TEST(CoarseCoordinates, AreNotReportedNearTheOriginOrInGlb) {
  const SolidSnapshot here = carved_block({700, -900, 40});
  EXPECT_EQ(warning(here, write(here, ModelFormat::kStl)), "");
  const SolidSnapshot there = carved_block({990'000, -990'000, 0});
  const ModelSummary glb = write(there, ModelFormat::kGlb);
  EXPECT_EQ(glb.collapsed, 0U);
  EXPECT_EQ(warning(there, glb), "");
}

TEST(CoarseCoordinates, ReportAStepSmallerThanATriangle) {
  ModelSummary summary{.triangles = 9, .farthest_mm = 700'000};
  const Vec3 least{699'990, 0, 0}, size{10, 10, 10};
  EXPECT_NE(coarse_coordinates(summary, 0.5, least, size, kOption), "");
  EXPECT_EQ(coarse_coordinates(summary, 2, least, size, kOption), "");
  summary.collapsed = 1;
  EXPECT_NE(coarse_coordinates(summary, 2, least, size, kOption), "");
}

}  // namespace
}  // namespace kerf::coarse_coordinates_test
