// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/canon_record.h"
#include "tests/support/test.h"

namespace kerf::gcode_compensation_test {
namespace {

using test::calls_of;
using test::moves_of;
using test::run_error_of;
using testing::HasSubstr;

const std::string kStart = "G21 G17 G90 G94 F100\nT1 M6\nG0 X-10 Y-5 Z0\n";

TEST(GcodeCompensation, RoundsOutsideCornersWithArcs) {
  // A square of 10 mm, clockwise, with the tool of 2 mm diameter outside it.
  EXPECT_EQ(
      moves_of(kStart + "G41 D1\nG1 X0 Y-5\nY10\nX10\nY0\nX-5\nG40\nG0 Z5\nM2\n"),
      "R -10 -5 0, F -1 -4 0, F -1 10 0, A 0 11 0, F 10 11 0, A 11 10 0, F 11 0 0, A 10 -1 0, "
      "F -5 -1 0, R -5 0 5");
}

TEST(GcodeCompensation, StopsAtTheIntersectionInInsideCorners) {
  EXPECT_EQ(moves_of(kStart + "G42 D1\nG1 X0 Y-5\nY10\nX10\nY0\nG40\nG0 Z5\nM2\n"),
            "R -10 -5 0, F 0 -6 0, A 1 -5 0, F 1 9 0, F 9 9 0, F 9 0 0, R 10 0 5");
}

// The tool center is never closer to the programmed contour than the tool's radius.
TEST(GcodeCompensation, StaysOutsideOfAPolygon) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> radius(15, 30);
  for (int round = 0; round < 200; ++round) {
    std::vector<Vec3> corners;
    for (int k = 0; k < 8; ++k) {
      const double angle = -k * 3.14159265358979 / 4;
      const double r = radius(random);
      corners.push_back({r * std::cos(angle), r * std::sin(angle), 0});
    }
    std::string text = "F100 G21\nT2 M6\nG0 X60 Y10 Z0\nG41\n";
    for (int k = 0; k <= 8; ++k)
      text += "G1 X" + std::to_string(corners[static_cast<std::size_t>(k % 8)].x) + " Y" +
              std::to_string(corners[static_cast<std::size_t>(k % 8)].y) + "\n";
    text += "G40\nG0 X60 Y20\nM2\n";
    const auto calls = calls_of(text);
    // The corner where the contour closes is not rounded, so its edges are not checked.
    for (std::size_t i = 2; i + 1 < calls.size(); ++i)
      for (std::size_t k = 1; k < 7; ++k) {
        const Vec3 a = corners[k];
        const Vec3 edge = corners[(k + 1) % 8] - a;
        const double s = std::clamp(dot(calls[i].to - a, edge) / dot(edge, edge), 0.0, 1.0);
        EXPECT_GT(length(calls[i].to - (a + edge * s)), 2 - 0.01) << text;
      }
  }
}

TEST(GcodeCompensation, FirstMoveAfterG40MustBeStraight) {
  EXPECT_THAT(run_error_of(kStart + "G41 D1\nG1 X0\nX10\nG40\nG2 X12 Y0 I1 J0\nM2\n").reason,
              HasSubstr("must be straight"));
}

TEST(GcodeCompensation, DelayedMovesKeepTheirLineNumbers) {
  const auto calls = calls_of(kStart + "G41 D1\nG1 X0 Y-5\nY10\nG40\nG0 Z5\nM2\n");
  ASSERT_EQ(calls.size(), 5u);
  EXPECT_EQ(calls[2].line, 5u);
  EXPECT_EQ(calls[3].line, 6u);
  EXPECT_EQ(calls[4].line, 8u);
}

struct Bad {
  const char* text;
  std::size_t line;
  const char* reason;
};
class BadCompensation : public testing::TestWithParam<Bad> {};

TEST_P(BadCompensation, IsRejected) {
  const ProgramError error = run_error_of(kStart + GetParam().text + "\nM2\n");
  EXPECT_EQ(error.line, GetParam().line) << error.reason;
  EXPECT_THAT(error.reason, HasSubstr(GetParam().reason));
}

INSTANTIATE_TEST_SUITE_P(
    GcodeCompensation, BadCompensation,
    testing::Values(
        Bad{"G41 D1\nG1 X-9.5", 5, "longer than the tool's radius"}, Bad{"G41 D9", 4, "no tool 9"},
        Bad{"G19 G41 D1", 4, "requires the plane XY"}, Bad{"G41.1", 4, "requires D"},
        Bad{"G41 D1\nG42 D1", 5, "compensation is on"}, Bad{"G41 D1\nG55", 5, "compensation is on"},
        Bad{"G41 D1\nG43 H1", 5, "compensation is on"}, Bad{"G41 D1\nG28", 5, "compensation is on"},
        Bad{"G41 D1\nM6", 5, "compensation is on"}, Bad{"G41 D1\nG18", 5, "compensation is on"},
        Bad{"G41 D1\nG0 X#5420", 5, "cannot be read"},
        Bad{"G41 D1\nG53 G0 X0", 5, "compensation is on"},
        Bad{"G41 D1\nG1 X0\nG3 X0.5 I0.25", 6, "greater than the tool's"},
        Bad{"G41 D3\nG1 X0\nX1 Y-5\nX1 Y-4.5\nX0", 7, "without gouging"}),
    [](const auto& name) { return "Case" + std::to_string(name.index); });

}  // namespace
}  // namespace kerf::gcode_compensation_test
