// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/canon_record.h"
#include "tests/support/test.h"

namespace kerf::gcode_cycle_test {
namespace {

using test::calls_of;
using test::moves_of;
using test::run_error_of;
using testing::HasSubstr;

const std::string kStart = "G21 G90 G94 F100 S500 M3\nG0 X0 Y0 Z10\n";

TEST(GcodeCycle, DrillsFromRAndRetractsByG98OrG99) {
  EXPECT_EQ(
      moves_of(kStart + "G98 G81 X1 Y2 Z-5 R3\nX4\nG80\nM2\n"),
      "R 0 0 10, R 1 2 10, R 1 2 3, F 1 2 -5, R 1 2 10, R 4 2 10, R 4 2 3, F 4 2 -5, R 4 2 10");
  EXPECT_EQ(moves_of(kStart + "G99 G81 X1 Z-5 R3\nX4\nM2\n"),
            "R 0 0 10, R 1 0 10, R 1 0 3, F 1 0 -5, R 1 0 3, R 4 0 3, F 4 0 -5, R 4 0 3");
  EXPECT_EQ(moves_of("F100\nG0 X0 Y0 Z1\nG98 G81 X1 Z-5 R3\nM2\n"),
            "R 0 0 1, R 0 0 3, R 1 0 3, F 1 0 -5, R 1 0 3");
}

TEST(GcodeCycle, RepeatsAdvanceInIncrementalMode) {
  EXPECT_EQ(moves_of(kStart + "G91 G99 G81 X5 Z-2 R-8 L2\nM2\n"),
            "R 0 0 10, R 5 0 10, R 5 0 2, F 5 0 0, R 5 0 2, R 10 0 2, F 10 0 0, R 10 0 2");
}

TEST(GcodeCycle, WorksInEveryPlane) {
  EXPECT_EQ(moves_of("F100\nG0 X0 Y10 Z0\nG18 G99 G81 X1 Z2 Y-5 R3\nM2\n"),
            "R 0 10 0, R 1 10 2, R 1 3 2, F 1 -5 2, R 1 3 2");
  EXPECT_EQ(moves_of("F100\nG0 X10 Y0 Z0\nG19 G99 G81 Y1 Z2 X-5 R3\nM2\n"),
            "R 10 0 0, R 10 1 2, R 3 1 2, F -5 1 2, R 3 1 2");
}

TEST(GcodeCycle, PeckDwellAndBoreCyclesExpandAsInLinuxCnc) {
  EXPECT_EQ(moves_of(kStart + "G99 G83 X0 Z-1 R1 Q1.5\nM2\n"),
            "R 0 0 10, R 0 0 10, R 0 0 1, F 0 0 -0.5, R 0 0 1, R 0 0 -0.246, F 0 0 -1, R 0 0 1");
  EXPECT_EQ(moves_of(kStart + "G99 G73 X0 Z-1 R1 Q1.5\nM2\n"),
            "R 0 0 10, R 0 0 10, R 0 0 1, F 0 0 -0.5, R 0 0 -0.246, F 0 0 -1, R 0 0 1");
  EXPECT_EQ(moves_of(kStart + "G99 G82 X0 Z-1 R1 P0.5\nM2\n"),
            "R 0 0 10, R 0 0 10, R 0 0 1, F 0 0 -1, D 0.5, R 0 0 1");
  EXPECT_EQ(moves_of(kStart + "G99 G85 X0 Z-1 R1\nM2\n"),
            "R 0 0 10, R 0 0 10, R 0 0 1, F 0 0 -1, F 0 0 1, R 0 0 1");
  EXPECT_EQ(moves_of(kStart + "G99 G89 X0 Z-1 R1 P2\nM2\n"),
            "R 0 0 10, R 0 0 10, R 0 0 1, F 0 0 -1, D 2, F 0 0 1");
  EXPECT_EQ(moves_of(kStart + "G99 G84 X0 Z-1 R1\nM2\n"),
            "R 0 0 10, R 0 0 10, R 0 0 1, F 0 0 -1, D 0, F 0 0 1");
  EXPECT_EQ(moves_of(kStart + "G99 G87 X0 Z-4 R1 I2 J3 K-2\nM2\n"),
            "R 0 0 10, R 0 0 10, R 0 0 1, R 2 3 1, R 2 3 -4, R 0 0 -4, F 0 0 -2, F 0 0 -4, R 2 3 "
            "-4, R 2 3 1, R 0 0 1");
  // The operator retracts manually, so the next hole starts from the bottom of this one.
  EXPECT_EQ(moves_of(kStart + "G99 G88 X0 Z-1 R1 P1\nM2\n"),
            "R 0 0 10, R 0 0 10, R 0 0 1, F 0 0 -1, D 1");
}

// In program units, as in LinuxCNC, the last bit decides whether the last peck reaches the bottom.
// In mm the last peck of each would end there.
TEST(GcodeCycle, CountsPecksInProgramUnits) {
  const auto feeds = [](const std::string& program) {
    const std::string moves = moves_of("G20 G90 G94 F100 S500 M3\n" + program + "\nM2\n");
    return std::ranges::count(moves, 'F');
  };
  EXPECT_EQ(feeds("G0 X0 Y0 Z0.263\nG91 G98 G73 X1 Z-0.162 R-0.019 Q0.054"), 4);
  EXPECT_EQ(feeds("G0 X0 Y0 Z1\nG98 G83 X1 Z-0.021 R0.001 Q0.011"), 3);
  // The second cycle starts at the level at which the first one ended.
  EXPECT_EQ(feeds("G0 X0 Y0 Z0.5\nG91 G99 G81 X1 Z-0.1 R-0.237\nG73 X1 Z-0.162 R-0.019 Q0.054"),
            1 + 4);
  // 0.771 inch in mm divided by 25.4 is not 0.771.
  EXPECT_EQ(feeds("G0 X0 Y0 Z0.771\nG91 G98 G73 X1 Z-0.118 R-0.001 Q0.059"), 3);
}

// LinuxCNC swaps the axes of G74 and G84 in G18 and G19. Kerf taps along the plane's normal.
TEST(GcodeCycle, TapsAlongTheNormalOfEveryPlane) {
  EXPECT_EQ(moves_of("F100 S100 M3\nG0 X10 Y0 Z0\nG19 G99 G84 Y1 Z2 X-5 R3\nM2\n"),
            "R 10 0 0, R 10 1 2, R 3 1 2, F -5 1 2, D 0, F 3 1 2");
}

TEST(GcodeCycle, HolesMayBeInPolarCoordinates) {
  EXPECT_EQ(moves_of(kStart + "G99 G81 @5 ^90 Z-1 R1\n^180\nM2\n"),
            "R 0 0 10, R 0 5 10, R 0 5 1, F 0 5 -1, R 0 5 1, R -5 0 1, F -5 0 -1, R -5 0 1");
}

TEST(GcodeCycle, RigidTapFeedsDownAndBackAtPitchTimesSpeed) {
  const auto calls = calls_of("S120 M3\nG0 X1 Y1 Z5\nG33.1 Z-3 K0.5\nM2\n");
  ASSERT_EQ(calls.size(), 3u);
  EXPECT_EQ(calls[1].to, (Vec3{1, 1, -3}));
  EXPECT_EQ(calls[1].value, 60);
  EXPECT_EQ(calls[2].to, (Vec3{1, 1, 5}));
}

struct Bad {
  const char* text;
  const char* reason;
};
class BadCycle : public testing::TestWithParam<Bad> {};

TEST_P(BadCycle, IsRejected) {
  const ProgramError error = run_error_of(kStart + GetParam().text + "\nM2\n");
  EXPECT_EQ(error.line, 3u);
  EXPECT_THAT(error.reason, HasSubstr(GetParam().reason));
}

INSTANTIATE_TEST_SUITE_P(
    GcodeCycle, BadCycle,
    testing::Values(Bad{"G81 X1 Z-1", "requires R"}, Bad{"G81 X1 R1", "requires the bottom"},
                    Bad{"G81 Z1 R-1", "below the bottom"}, Bad{"G82 Z-1 R1", "requires P"},
                    Bad{"G83 Z-1 R1", "requires Q"}, Bad{"G83 Z-1 R1 Q0", "above 0"},
                    Bad{"G81 Z-1 R1 L0", "repeats"}, Bad{"G81 Z-1 R1 A5", "rotary axes"},
                    Bad{"G93 G81 Z-1 R1 F1", "inverse time"}, Bad{"M5 G86 Z-1 R1 P1", "spindle"},
                    Bad{"M4 G84 Z-1 R1", "wrong direction"},
                    Bad{"G41 D1 G81 Z-1 R1", "compensation"}, Bad{"G81", "requires axis words"},
                    Bad{"G33.1 Z-1 K0", "pitch"}),
    [](const auto& name) { return "Case" + std::to_string(name.index); });

}  // namespace
}  // namespace kerf::gcode_cycle_test
