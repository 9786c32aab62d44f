// SPDX-License-Identifier: Apache-2.0
#include "tests/paper/check.h"
#include "tests/paper/examples.h"
#include "tests/paper/page.h"
#include "tests/paper/voxel_block.h"
#include "tests/support/test.h"

namespace kerf::paper::paper_test {
namespace {

class PaperCheck : public testing::TestWithParam<Check> {};

TEST_P(PaperCheck, Holds) {
  const Finding& finding = found(GetParam().name);
  EXPECT_TRUE(finding.holds) << finding.figures;
}

INSTANTIATE_TEST_SUITE_P(Page, PaperCheck, testing::ValuesIn(checks()),
                         [](const auto& check) { return std::string(check.param.name); });

TEST(PaperPage, EqualsTheGeneratedPage) {
  const std::string committed = test::content_of(KERF_SOURCE_DIR "/tests/paper/page.md");
  int failed = 0;
  // The tests of other programs run on their own. Here each row must name some that exist.
  const std::string page = page_text(has_tests, failed);
  EXPECT_EQ(failed, 0);
  EXPECT_EQ(committed, page);
}

TEST(PaperPage, RowsWithFailingOrMissingTestsFail) {
  const Row none{.program = "kernel/kerf_kernel_test", .check = "NoSuch.Test"};
  EXPECT_FALSE(has_tests(none));
  EXPECT_FALSE(run_tests(none));
  EXPECT_FALSE(run_tests({.program = "kernel/no_such_program", .check = "Cut.*"}));
  const Row cut{.program = "kernel/kerf_kernel_test", .check = "Cut.ShortensTheTop"};
  EXPECT_TRUE(has_tests(cut));
  EXPECT_TRUE(run_tests(cut));
  EXPECT_FALSE(found("NoSuchCheck").holds);
}

TEST(VoxelBlock, RemovesTheVoxelsWhoseCentersTheMillReaches) {
  // A ball that moves along X, lowest in the middle of the block, and a flat mill on a ramp.
  for (const bool ball : {true, false}) {
    VoxelBlock block({{0, 0, 0}, {12, 8, 20}}, 0.25);
    const Mill mill{ball, 2};
    const Vec3 from{3, 4, 12}, to{9, 4.5, 15};
    EXPECT_EQ(block.voxels(), std::size_t{48 * 32 * 80});
    block.cut(mill, from, to);
    for (int j = 0; j < block.columns_y(); ++j) {
      for (int i = 0; i < block.columns_x(); ++i) {
        // The lowest of many poses.
        double low = 1e9;
        for (int n = 0; n <= 4000; ++n) {
          const Vec3 tip = from + (to - from) * (n / 4000.0);
          const double dx = block.x_mm(i) - tip.x, dy = block.y_mm(j) - tip.y;
          const double under = 4 - dx * dx - dy * dy;
          if (under >= 0) low = std::min(low, tip.z + (ball ? 2 - std::sqrt(under) : 0));
        }
        EXPECT_NEAR(block.top_mm(i, j), std::min(low, 20.0), 0.125 + 5e-3) << i << " " << j;
      }
    }
  }
}

TEST(Examples, BirdRisesAboveItsGround) {
  // A height field that is below the stock's top, and empty at the corners of the picture.
  double most = 0;
  for (double x = 0; x < 70; x += 0.5) {
    for (double y = 0; y < 56; y += 0.5) most = std::max(most, bird_height(x, y));
  }
  EXPECT_GT(most, 5);
  EXPECT_LT(most, 6.5);
  EXPECT_EQ(bird_height(1, 55), 0);
  EXPECT_EQ(bird_height(69, 55), 0);
}

}  // namespace
}  // namespace kerf::paper::paper_test
