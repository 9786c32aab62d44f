// SPDX-License-Identifier: Apache-2.0
// Blocks of Fanuc and Haas, against paths computed by hand.
#include "tests/formats/dialect_runs.h"
#include "tests/support/test.h"

namespace kerf::gcode_fanuc_test {
namespace {

using test::as;
using test::fanuc;
using test::haas;
using test::refused;
using testing::Contains;
using testing::HasSubstr;

TEST(FanucBlock, StartsInRapidAndTheLastCodeOfAGroupCounts) {
  EXPECT_EQ(fanuc("X1 Y2\nM30\n"), "R 1 2 0");
  EXPECT_EQ(fanuc("G90 G91 G1 G0 X1\nX1\nM30\n"), "R 1 0 0, R 2 0 0");
  EXPECT_EQ(fanuc("g1 x1 f100 n5 (a (nested) one) y2 (open\nM30\n"), "F 1 2 0");
  EXPECT_EQ(fanuc("G1 F100 X1\nG81 Z-1 R1 L0\nX5 Y5\nG80\nX7\nM30\n"),
            "F 1 0 0, R 1 0 1, R 5 5 1, F 5 5 -1, R 5 5 1, F 7 5 1");
  EXPECT_EQ(fanuc("/G0 X1\n/2 G0 X2\nG0 X3 /Y4\nM30\n"), "R 3 0 0");
  EXPECT_EQ(fanuc("G1 X5 F100\nG2 X7 I1 J0 K0\nM30\n"), "F 5 0 0, A 7 0 0");
  EXPECT_THAT(refused("G1 X5 F100\nG2 X7 I1 K1\nM30\n"), HasSubstr("K1"));
  EXPECT_THAT(refused("G2 X7 F1\n"), HasSubstr("requires R or the center"));
}

TEST(FanucBlock, HomesDwellsAndCodesWithoutMotion) {
  EXPECT_EQ(fanuc("G1 X5 F100\nG0 G91 G28 Z0\nG90 X6\nM30\n"),
            "F 5 0 0, R 5 0 0, R 5 0 0, R 6 0 0");
  EXPECT_EQ(fanuc("G28 X Y\nG4 X1.5\nG4 P500\nG4 U2\nG4 P1.5\nM30\n"),
            "R 0 0 0, R 0 0 0, D 1.5, D 0.5, D 2, D 1.5");
  EXPECT_EQ(haas("G187 P3 E.01\nG103 P1\nM131\nG0 X1 M10\nG5.1 Q1\nG22 X9 Y9 Z9 I1 J1 K1\nM30\n"),
            "R 1 0 0");
  EXPECT_EQ(fanuc("G1 X1 F10\nG53 Z0\nX2\nM30\n"), "F 1 0 0, R 1 0 0, F 2 0 0");
  EXPECT_THAT(refused("G150 X1\n"), HasSubstr("G150"));
  EXPECT_THAT(refused("#5230=30.\n"), HasSubstr("5230"));  // LinuxCNC's rotation of G54
  EXPECT_THAT(refused("#7007=1.\n"), HasSubstr("7007"));
  EXPECT_THAT(refused("G31 X1 F1\n"), HasSubstr("probing"));
  EXPECT_THAT(refused("G68.2 X0 Y0 Z0 I0 J30 K0\n"), HasSubstr("tilts the working plane"));
}

// I is the radius of the hole; D1 takes 1 mm off. Half a circle leads to it and back.
TEST(FanucBlock, OnlyAPercentSignAloneOnItsLineEndsTheProgram) {
  const std::string moves = "G0 X1\nG1 X2 F10\n";
  EXPECT_EQ(fanuc("%\nO1\n" + moves + "% LED ON\nX3\n%\nX4\n"),
            fanuc("%\nO1\n" + moves + "X3\n%\nX4\n"));
  EXPECT_NE(fanuc("%\nO1\n" + moves + "% LED ON\nX3\n%\n"), fanuc("%\nO1\n" + moves + "%\n"));
}

TEST(FanucBlock, CircularPocketsOfHaas) {
  EXPECT_EQ(haas("T1\nG0 X10 Y20 Z1\nG13 I5. D1 Z-2. F100\nG1 X0\nM30\n"),
            "R 10 20 1, F 10 20 -2, A 14 20 -2, A 14 20 -2, A 10 20 -2, F 0 20 -2");
  EXPECT_EQ(haas("T1\nG91 G12 I2. K3.5 Q1. D0 Z-1. L2 F100\nM30\n"),
            "F 0 0 -1, A 2 0 -1, A 2 0 -1, F 3 0 -1, A 3 0 -1, F 3.5 0 -1, A 3.5 0 -1, A 0 0 -1, "
            "F 0 0 -2, A 2 0 -2, A 2 0 -2, F 3 0 -2, A 3 0 -2, F 3.5 0 -2, A 3.5 0 -2, A 0 0 -2");
  EXPECT_EQ(test::moves_of("F100\nG12 I2\nM30\n", as(Dialect::kMach3)),
            "F 2 0 0, A 2 0 0, F 0 0 0");
  EXPECT_THAT(refused("T1\nG13 I0.5 D1 F9\n", Dialect::kHaas), HasSubstr("tool's radius"));
  EXPECT_THAT(refused("T1\nG13 I5. K9. D1 F9\n", Dialect::kHaas), HasSubstr("Q"));
  EXPECT_THAT(refused("G12 I5. F9\n"), HasSubstr("'G12' is not a supported code"));
}

TEST(FanucBlock, HolesOnACircleOfHaas) {
  EXPECT_EQ(haas("F9\nG0 X10 Y0 Z5\nG81 Z-1. R1. L0\nG70 I5. J90. L2\nG80\nM30\n"),
            "R 10 0 5, R 10 5 5, R 10 5 1, F 10 5 -1, R 10 5 5, R 10 -5 5, R 10 -5 1, F 10 -5 -1, "
            "R 10 -5 5");
  EXPECT_EQ(haas("F9\nG81 G99 Z-1. R1. G71 I5. J0 K90. L2\nG80\nM30\n"),
            "R 0 0 1, R 5 0 1, F 5 0 -1, R 5 0 1, R 5 0 1, R 0 5 1, F 0 5 -1, R 0 5 1");
  EXPECT_EQ(haas("F9\nG0 X10 Y0 Z5\nG81 Z-1. R1. L0\nG72 I5. J90. L3\nG80\nM30\n"),
            "R 10 0 5, R 10 0 5, R 10 0 1, F 10 0 -1, R 10 0 5, R 10 5 5, R 10 5 1, F 10 5 -1, "
            "R 10 5 5, R 10 10 5, R 10 10 1, F 10 10 -1, R 10 10 5");
  EXPECT_THAT(refused("G72 I5. J0 L2\n"), HasSubstr("pattern of holes"));
  EXPECT_THAT(refused("G70 I5. L2\n", Dialect::kHaas), HasSubstr("active canned cycle"));
}

// G40 alone causes no motion. A retraction after it goes straight up.
TEST(FanucBlock, RetractionAfterG40StaysOffThePath) {
  const std::string start = "T1\nG41 D1 G1 X-20 Y0 F9\nX0\nG40\n";
  EXPECT_EQ(fanuc(start + "G0 Z9\nM30\n"), "F -20 1 0, F 0 1 0, R 0 1 9");
  EXPECT_EQ(fanuc(start + "G0 Z9\nX5\nM30\n"), "F -20 1 0, F 0 1 0, R 0 1 9, R 5 0 9");
  EXPECT_EQ(fanuc(start + "G91 X5\nM30\n"), "F -20 1 0, F 0 1 0, F 5 0 0");
}

// The tool has a radius of 1 mm.
TEST(FanucBlock, G41StartsAcrossTheNextMoveAndEndsAcrossTheLast) {
  const std::string start = "T1\nG0 X-40 Y-20\nG41 D1 G1 X0 F9\n";
  EXPECT_EQ(fanuc(start + "Y30\nG40 X-40\nM30\n"),
            "R -40 -20 0, F -1 -20 0, F -1 30 0, F -40 30 0");
  EXPECT_EQ(haas("T1\nG0 X-40 Y-20\nG42 D1 G1 X0 F9\nY30\nG40 X-40\nM30\n"),
            "R -40 -20 0, F 1 -20 0, F 1 30 0, F -40 30 0");
  EXPECT_EQ(fanuc(start + "G3 X0 Y20 J20\nG40 G1 X-40\nM30\n"),
            "R -40 -20 0, F 0 -19 0, A 0 19 0, F -40 20 0")
      << "across the tangent of an arc";
  EXPECT_EQ(fanuc(start + "Z-3\nY30\nG40 X-40\nM30\n"),
            "R -40 -20 0, F -1 -20 0, F -1 -20 -3, F -1 30 -3, F -40 30 -3")
      << "an infeed in between does not decide";
  EXPECT_EQ(fanuc("T1\nG0 X-40 Y-20\nG41 D1 G1 Z-3 F9\nX0\nY30\nG40 X-40\nM30\n"),
            "R -40 -20 0, F -40 -20 -3, F -1 -20 -3, F -1 30 -3, F -40 30 -3")
      << "an infeed is no entry";
  EXPECT_EQ(fanuc("T1\nG0 X-0.5 Y-20\nG41 D1 G1 X0 F9\nY30\nG40 X-40\nM30\n"),
            "R -0.5 -20 0, F -1 -20 0, F -1 30 0, F -40 30 0")
      << "an entry may be shorter than the radius";
  EXPECT_EQ(test::moves_of("T1 M6\nG0 X-40 Y-20\nG41 D1 G1 X0 F9\nY30\nG40 X-40\nM2\n"),
            "R -40 -20 0, F -1 -19 0, F -1 30 0, F -40 30 0")
      << "LinuxCNC: across the entry";
}

TEST(FanucBlock, ACycleKeepsItsLevelsWhenG91Begins) {
  // Holes at X 0, 10 and 20, to Z-8 from R2, with the tool at Z20 before.
  const std::string holes =
      "R 0 0 20, R 0 0 2, F 0 0 -8, R 0 0 2, R 10 0 2, F 10 0 -8, R 10 0 2, R 20 0 2, F 20 0 -8, "
      "R 20 0 2";
  EXPECT_EQ(haas("G0 Z20\nG81 G99 X0 Y0 Z-8. R2. F9\nG91 X10. L2\nG80\nM30\n"),
            "R 0 0 20, " + holes);
  EXPECT_EQ(fanuc("G0 Z20\nG81 G99 X0 Y0 Z-8. R2. F9\nG91 X10. K2\nG80\nM30\n"),
            "R 0 0 20, " + holes);
  EXPECT_EQ(haas("G0 Z20\nG91 G81 G99 X0 Y0 Z-10. R-18. F9\nG90 X10.\nX20.\nG80\nM30\n"),
            "R 0 0 20, " + holes)
      << "G91 first";
  EXPECT_EQ(haas("G0 Z20\nG81 G99 Z-8. R2. F9 L0\nG91 X10.\nG80\nM30\n"),
            "R 0 0 20, R 10 0 20, R 10 0 2, F 10 0 -8, R 10 0 2");
  EXPECT_EQ(
      test::moves_of("M3 S9\nG0 Z20\nG81 G99 X0 Y0 Z-8 R2 F9\nG91 X10\nG80\nM2\n"),
      "R 0 0 20, R 0 0 20, R 0 0 2, F 0 0 -8, R 0 0 2, R 0 0 22, R 10 0 22, F 10 0 14, R 10 0 22")
      << "LinuxCNC reads the levels again";
}

TEST(FanucBlock, OffsetsAreInTheUnitOfTheProgram) {
  EXPECT_EQ(fanuc("G20\n#5221=1.\nG0 X1.\nM30\n"), "R 50.8 0 0");
  EXPECT_EQ(fanuc("#5221=25.4\nG20\nG0 X#5221\nG21\nX#5221\nM30\n"), "R 50.8 0 0, R 50.8 0 0");
}

TEST(FanucBlock, RotatesTheProgramAboutACenter) {
  // Y1 next to (10, 0), turned by 90 degrees, is X-1 next to it.
  EXPECT_EQ(fanuc("G68 X10 Y0 R90\nG0 X10 Y1\nG1 X11 Y0 F9\nG69\nG0 X1 Y2\nM30\n"),
            "R 9 0 0, F 10 1 0, R 1 2 0");
  EXPECT_EQ(fanuc("G52 X100\nG68 X10 Y0 R180\nG0 X11 Y0\nG69\nG0 X0 Y0\nM30\n"),
            "R 109 0 0, R 100 0 0");
  EXPECT_EQ(fanuc("G68 X0 Y0 R90\nG1 X1 Y0 F9\nG3 X0 Y1 I-1 J0\nM30\n"), "F 0 1 0, A -1 0 0");
  EXPECT_THAT(refused("G0 X3 Y4\nG68 X0 Y0 R90\nG0 X1\n"), HasSubstr("both X and Y"));
  EXPECT_THAT(refused("G68 X0 Y0 R90\nG55\n"), HasSubstr("G55"));
  EXPECT_THAT(refused("G18 G68 X0 Z0 R90\n"), HasSubstr("G17"));
  EXPECT_EQ(test::moves_of("G68 A10 B0 R90\nG0 X10 Y1\nG69\nX1 Y2\nM30\n", as(Dialect::kMach3)),
            "R 9 0 0, R 1 2 0");
  EXPECT_THAT(refused("G68 A10 B0 I1 R9\n", Dialect::kMach3), HasSubstr("X, Y and R only"));
  EXPECT_EQ(test::moves_of("G68 A10 B0 R90\nG0 X10 Y1\nG69\nX1 Y2\nM30\n", as(Dialect::kMach3)),
            "R 9 0 0, R 1 2 0");
  EXPECT_THAT(refused("G68 A10 B0 I1 R9\n", Dialect::kMach3), HasSubstr("X, Y and R only"));
  EXPECT_THAT(refused("G51 X0 Y0 I2. J2.\n", Dialect::kMach3), HasSubstr("(read as Mach3)"));
}

TEST(FanucBlock, ScalesAndMirrors) {
  EXPECT_EQ(fanuc("G51 X10 Y0 I2000 J2000\nG1 X11 Y1 F9\nG50\nG1 X1 Y1\nM30\n"),
            "F 12 2 0, F 1 1 0");
  EXPECT_EQ(fanuc("G51.1 X5\nG1 X6 Y1 F9\nG2 X8 Y1 I1 J0\nG50.1 X0\nG1 X1 Y1\nM30\n"),
            "F 4 1 0, A 2 1 0, F 1 1 0");
  EXPECT_EQ(haas("G101 X0 Y0\nG1 X6 Y1 F9\nG100\nG1 X1 Y1\nM30\n"), "F -6 -1 0, F 1 1 0");
  EXPECT_THAT(refused("G51 X0 Y0 Z0 P2.\n"), HasSubstr("scales Z"));
  EXPECT_THAT(refused("G51 X0 Y0 I2 J2\n"), HasSubstr("ambiguous"));
  EXPECT_THAT(refused("G51 X0 Y0 I2. J1.\nG1 X1 Y0 F9\nG2 X3 Y0 I1 J0\n"),
              HasSubstr("unequal scale"));
}

TEST(FanucBlock, CancelingAnotherTransformationChangesNothing) {
  EXPECT_EQ(fanuc("G51.1 X0\nG69\nG50\nG0 X10 Y0\nG50.1 X0\nX20 Y1\nM30\n"), "R -10 0 0, R 20 1 0");
  EXPECT_EQ(haas("G68 X0 Y0 R90\nG50\nG50.1 X0\nG0 X20 Y0\nG69\nX1 Y2\nM30\n"),
            "R 0 20 0, R 1 2 0");
  EXPECT_EQ(fanuc("G51 X0 Y0 I2. J2.\nG69\nG100\nG0 X1 Y1\nG50\nX1 Y1\nM30\n"), "R 2 2 0, R 1 1 0");
  EXPECT_THAT(refused("G50.1 G0 X5\n"), HasSubstr("without a motion code"));
}

TEST(FanucBlock, ScalingDoesNotScaleTheTool) {
  // A tool of 2 mm to the left of the line Y-20 is at Y-19.
  EXPECT_THAT(fanuc("G0 X0 Y-20\nG51 X0 Y0 I2. J2.\nG1 X-20 Y-20 F9\nG41 D1 X-10 Y-10\nX10\n"
                    "G40 X20 Y-10\nM30\n"),
              HasSubstr("F 20 -19 0"));
  EXPECT_THAT(refused("T1\nG51 X0 Y0 I2. J1.\nG41 D1 X1 Y1 F9\n"), HasSubstr("ellipse"));
}

TEST(FanucBlock, AssigningTheActiveWorkOffsetMovesTheWorkZero) {
  EXPECT_EQ(fanuc("#5221=50. #5222=20.\nG54 G0 X0 Y0\nX10\nM30\n"), "R 50 20 0, R 60 20 0");
  EXPECT_EQ(fanuc("#7001=50.\nG54.1 P1\n#7001=30.\nG0 X0 Y0\nM30\n"), "R 30 0 0");
  EXPECT_THAT(refused("G68 X0 Y0 R90\n#5221=5.\nG0 X1 Y0\n"), HasSubstr("#5221"));
  EXPECT_THAT(refused("T1\nG41 D1 G1 X9 Y9 F9\n#5221=5.\nX10\n"), HasSubstr("#5221"));
}

TEST(FanucBlock, ACompensatedPathKeepsItsCoordinateSystem) {
  const std::string start = "T1\nG10 L2 P2 Y40\nG41 D1 G1 X-20 Y0 F9\n";
  EXPECT_THAT(refused(start + "G55\nX10\n"), HasSubstr("'G55' is not allowed while cutter"));
  EXPECT_THAT(refused(start + "G54.1 P1\nX10\n"), HasSubstr("'G54.1' is not allowed while"));
  EXPECT_THAT(refused(start + "G54 P1\nX10\n"), HasSubstr("'G54' is not allowed while cutter"));
  EXPECT_THAT(fanuc(start + "G54\nX30\nG40 X50\nM30\n"), HasSubstr("F 50 0 0"));
}

TEST(FanucBlock, PAfterG54IsAnAdditionalSystem) {
  EXPECT_EQ(fanuc("G10 L20 P2 X5\nG54 P2\nG0 X1\nG54\nX1\nM30\n"), "R 6 0 0, R 1 0 0");
  EXPECT_THAT(refused("G54 P2 M131\n"), HasSubstr("write them in two blocks"));
  EXPECT_EQ(fanuc("G10 L20 P2 X5\nG54.1 P2 M131\nG0 X1\nM30\n"), "R 6 0 0");
}

TEST(FanucBlock, KOfHaasPecksIsNoRepeatCount) {
  EXPECT_EQ(haas("G91 G98 G83 X10 Z-5 R-1 I2. J0.5 K2. F9\nG80\nM30\n"),
            fanuc("G91 G98 G83 X10 Z-5 R-1 F9\nG80\nM30\n"));
}

TEST(FanucBlock, G70AndG71AreUnitsUnlessTheyDescribeAPattern) {
  EXPECT_EQ(fanuc("G70\nG1 X1. F1.\nG71\nX2.\nM30\n"), "F 25.4 0 0, F 2 0 0");
  EXPECT_THAT(refused("G70 I1. J0 L4\n"), HasSubstr("pattern of holes"));
}

TEST(FanucBlock, MessagesAndSpindlePowerAreIgnored) {
  EXPECT_EQ(fanuc("MSG\"Tool: #1 (3 mm)\"\nM3 P100\nG1 X1 F9\nM5 P0\nM30\n"), "F 1 0 0");
}

TEST(MacroPrograms, CompensationMayBeRepeatedOnItsSide) {
  const Scene scene = test::scene_for("xyz");
  const std::string start = "G21\nT1 M6\nG0 X-40 Y0 Z5\nG41 D1 G1 X-20 F9\nX0\n";
  const auto read = [&](const std::string& rest) {
    return parse_program("p.nc", start + rest, scene, as(Dialect::kFanuc));
  };
  const auto repeated = test::value_of(read("G41 X9\nX20\nM30\n"));
  const auto once = test::value_of(read("X9\nX20\nM30\n"));
  EXPECT_TRUE(repeated.motions == once.motions);
  EXPECT_NE(repeated.motions.back().to.tip_mm.y, 0) << "beside the path";
}

TEST(MacroPrograms, CentersAreAbsoluteIfNothingElseGivesAnArc) {
  const Scene scene = test::scene_for("xyz");
  const std::string start = "G21\nT1 M6\nG0 X-40 Y50 Z5\nG1 Z-1 F100\n";
  const auto read = [&](const std::string& arcs) {
    return parse_program("p.nc", start + arcs + "M30\n", scene, as(Dialect::kFanuc));
  };
  const auto program = test::value_of(read("G3 X-50 Y40 I-40 J40\n"));
  EXPECT_THAT(program.warnings, Contains(HasSubstr("p.nc:5: I, J and K of all arcs")));
  for (const ProgramMotion& motion : program.motions) {
    if (motion.line != 5) continue;
    EXPECT_NEAR(std::hypot(motion.to.tip_mm.x + 40, motion.to.tip_mm.y - 40), 10, 1e-5);
    EXPECT_GE(motion.to.tip_mm.y, 40 - 1e-9) << "a quarter, counterclockwise";
  }
  EXPECT_THAT(read("G3 X-50 Y40 I0 J-10\nG3 X-40 Y30 I-40 J40\n").error().reason,
              HasSubstr("the radius of the arc"))
      << "one kind of center in a program";
}

TEST(MacroPrograms, OffsetsAreZeroIfTheToolRadiusIsImpossible) {
  const Scene scene = test::scene_for("xyz");
  const std::string text =
      "G21\nT1 M6\nG0 X0 Y0 Z5\nG1 Z-1 F100\nG41 D1 X0.5\nX30\nY1\nX0\nG40 Y2\nM30\n";
  const auto program = test::value_of(parse_program("p.nc", text, scene, as(Dialect::kFanuc)));
  EXPECT_THAT(program.warnings, Contains(HasSubstr("the offsets D are read as 0")));
  EXPECT_EQ(program.motions.at(2).to.tip_mm, (Vec3{30, 0, -1}));
}

TEST(GrblBlock, G10L20GivesTheCurrentPositionItsCoordinates) {
  EXPECT_EQ(test::moves_of("G0 X10 Y10\nG10 L20 P1 X0 Y0\nG0 X5 Y0\nM30\n", as(Dialect::kGrbl)),
            "R 10 10 0, R 15 10 0");
  EXPECT_EQ(test::moves_of("G91 G10 L2 P1 X3\nG10 L2 P1 X3\nG90 G0 X1\nM30\n", as(Dialect::kGrbl)),
            "R 4 0 0");
  EXPECT_THAT(refused("G10 L20 P1 X0\n", Dialect::kMach3), HasSubstr("'L20' of G10"));
  EXPECT_THAT(refused("G10 L2 P1 R30\n", Dialect::kGrbl), HasSubstr("R30"));
}

TEST(GrblBlock, SharesItsRulesWithMach3) {
  for (const Dialect dialect : {Dialect::kGrbl, Dialect::kMach3}) {
    SCOPED_TRACE(rules_of(dialect).label);
    const auto moves = [&](const std::string& text) { return test::moves_of(text, as(dialect)); };
    EXPECT_EQ(moves("X1 Y2\nM30\n"), "R 1 2 0") << "starts in G0";
    EXPECT_EQ(moves("G0 Z9\nG81 X1 Z-1 R2 F9\nG80\nM30\n"),
              "R 0 0 9, R 1 0 9, R 1 0 2, F 1 0 -1, R 1 0 9")
        << "starts in G98";
    EXPECT_EQ(moves("G90 G91 G1 G0 X1\nX1\nM30\n"), "R 1 0 0, R 2 0 0");
    EXPECT_EQ(moves("G0 X1 (a (nested) one) Y2 (open\nM30\n"), "R 1 2 0");
    EXPECT_EQ(moves("G4 P1\nG0 X5 M131\nX#1 Y1\nM30\n"), "D 1, R 5 0 0, R 0 1 0")
        << "a variable is 0 until it is assigned";
    EXPECT_EQ(moves("%\nO1\nG91\nM98 P2 L2\nG0 Y1\nM30\nO2 (SUB)\nG0 X1\nM99\n%\n"),
              "R 1 0 0, R 2 0 0, R 2 1 0");
  }
}

TEST(FanucBlock, AMirroredArcBulgesToTheOtherSide) {
  const Scene scene = test::scene_for("xyz");
  const auto lowest_and_highest = [&](const std::string& mirror) {
    GcodeEnvironment environment = as(Dialect::kFanuc);
    const auto program = parse_program(
        "p.nc", "T1 M6\nG0 X0 Y0 Z0\n" + mirror + "\nG1 X0 Y0 F100\nG2 X2 Y0 I1 J0\nM30\n", scene,
        environment);
    EXPECT_TRUE(program.has_value()) << to_string(program.error());
    double low = 0, high = 0;
    for (const ProgramMotion& motion : program ? program->motions : std::vector<ProgramMotion>{}) {
      low = std::min(low, motion.to.tip_mm.y);
      high = std::max(high, motion.to.tip_mm.y);
    }
    return std::pair(low, high);
  };
  EXPECT_NEAR(lowest_and_highest("").second, 1, 0.02);
  EXPECT_NEAR(lowest_and_highest("G51.1 Y0").first, -1, 0.02);
  EXPECT_NEAR(lowest_and_highest("G51.1 Y0").second, 0, 1e-9);
}

TEST(FanucBlock, RoundsAndCutsCorners) {
  EXPECT_EQ(fanuc("G1 X10 ,R2 F9\nY10\nM30\n"), "F 8 0 0, A 10 2 0, F 10 10 0");
  EXPECT_EQ(fanuc("G1 X10 ,C2 F9\nY10\nM30\n"), "F 8 0 0, F 10 2 0, F 10 10 0");
  EXPECT_EQ(fanuc("G1 X10 ,R2 F9\nY10 ,R1\nX0\nM30\n"),
            "F 8 0 0, A 10 2 0, F 10 9 0, A 9 10 0, F 0 10 0");
  EXPECT_THAT(refused("G1 X10 ,R20 F9\nY10\nM30\n"), HasSubstr("larger than one of its moves"));
  EXPECT_THAT(refused("G1 X10 ,R2 F9\nG0 Y10\nM30\n"), HasSubstr("must be followed by"));
  EXPECT_THAT(refused("G1 X10 ,R2 F9\nM30\n"), HasSubstr("must be followed by"));
  EXPECT_THAT(refused("G1 X10 ,R2 F9\nG1 Y10 Z1\nM30\n"), HasSubstr("within the active plane"));
}

TEST(FanucBlock, RoundsAndCutsCornersOfCompensatedPaths) {
  for (const std::string start : {"T1\nG41 D1 G1 X-20 Y0 F9\n", "T1\nG42 D1 G1 X-20 Y0 F9\n"}) {
    const std::string end = "X0\nY5\nM30\n";
    EXPECT_EQ(fanuc(start + "X10 ,R3.\nY10 ,C2.\n" + end),
              fanuc(start + "X7\nG3 X10 Y3 R3\nG1 Y8\nX8 Y10\n" + end));
  }
  // The corner at the end of the first line, which leads to the path.
  EXPECT_EQ(fanuc("T1\nG41 D1 G1 X-20 Y0 ,C2. F9\nY10\nX-30\nM30\n"),
            fanuc("T1\nG41 D1 G1 X-18 Y0 F9\nX-20 Y2\nY10\nX-30\nM30\n"));
  EXPECT_THAT(refused("T1\nG41 D1 G1 X-20 Y0 F9\nX10 ,R3.\nG40 Y20\n"),
              HasSubstr("must be followed by"));
}

TEST(FanucBlock, PolarCoordinatesAreRadiusAndAngle) {
  EXPECT_EQ(fanuc("G16\nG1 X10 Y90 F9\nY180\nG91 Y90\nG90 G15\nX1 Y1\nM30\n"),
            "F 0 10 0, F -10 0 0, F 0 -10 0, F 1 1 0");
  EXPECT_EQ(fanuc("G16\nG98 G81 X10 Y0 Z-1 R1 F9\nY90\nG80 G15\nM30\n"),
            "R 0 0 1, R 10 0 1, F 10 0 -1, R 10 0 1, R 10 0 1, R 0 10 1, F 0 10 -1, R 0 10 1");
  EXPECT_THAT(refused("G18 G16\nX1 Y5\n"), HasSubstr("G17"));
}

TEST(FanucBlock, CoordinateSystemsAndTheirOffsets) {
  EXPECT_EQ(fanuc("G10 L2 P1 X10\nG54 G0 X1\nG54.1 P2\nX1\nG10 L20 P2 Y5\nX1 Y1\nM30\n"),
            "R 11 0 0, R 1 0 0, R 1 6 0");
  EXPECT_EQ(haas("G10 L20 P1 X3\nG154 P1 G0 X1\nG54 X1\nG110 X2\nM30\n"),
            "R 4 0 0, R 1 0 0, R 5 0 0");
  EXPECT_EQ(fanuc("G10 L2 P2 X10\nG91 G10 L2 P2 X1\nG90 G55 G0 X1\nM30\n"), "R 12 0 0");
  EXPECT_THAT(refused("G10 L2 P0 X1\n"), HasSubstr("external offset"));
  EXPECT_EQ(fanuc("G10 L2 P0 X0 Y0. Z0\nG0 X1\nM30\n"), "R 1 0 0") << "cleared";
  EXPECT_THAT(refused("G10 L12 P1 R5\n"), HasSubstr("L12"));
}

TEST(FanucBlock, CyclesStartInG98AndNeedNoDwellOrSpindle) {
  EXPECT_EQ(fanuc("G0 Z9\nG82 X1 Z-1 R2 F9\nX2 K0\nG84 X3\nG80\nM30\n"),
            "R 0 0 9, R 1 0 9, R 1 0 2, F 1 0 -1, D 0, R 1 0 9, R 3 0 9, R 3 0 2, F 3 0 -1, "
            "D 0, F 3 0 9");
  EXPECT_EQ(fanuc("G0 Z9\nG99 G83 X1 Z-1 R2 Q9 F9\nG80\nM30\n"),
            "R 0 0 9, R 1 0 9, R 1 0 2, F 1 0 -1, R 1 0 2");
  EXPECT_THAT(refused("G87 X1 Z-1 R2 F9\n"), HasSubstr("back boring"));
}

TEST(FanucBlock, SelectedToolThatIsNeverLoadedNeedNotExist) {
  const Scene scene = test::scene_for("xyz");
  const std::string start = "O1\nG21 T1 M6\nT9\nG90 G0 X0 Y0 Z5\nG43 H21 Z5\n";
  const auto program = test::value_of(
      parse_program("p.nc", start + "G41 D31 G1 X20 Y20 F100\nX40\nG40 X60\nM30\n", scene));
  EXPECT_THAT(program.warnings, Contains(HasSubstr("radius of the scene's tool")));
  EXPECT_FALSE(parse_program("p.nc", start + "M6\nG1 X1 F9\nM30\n", scene).has_value());
  const auto without =
      test::value_of(parse_program("p.nc", "O1\nT2\nG0 X0 Y0 Z5\nG1 Z1 F9\nM30\n", scene));
  ASSERT_FALSE(without.motions.empty());
  EXPECT_EQ(without.motions.front().tool, 2u);
}

}  // namespace
}  // namespace kerf::gcode_fanuc_test
