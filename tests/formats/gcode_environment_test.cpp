// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/parameter_file.h"
#include "server/formats/gcode/tool_table.h"
#include "tests/formats/canon_record.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::gcode_environment_test {
namespace {

using test::moves_of;
using test::run_error_of;
using test::scene_for;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(ToolTable, WordsMayBeInAnyOrderWithComments) {
  const auto table = test::value_of(read_tool_table(
      "t.tbl", "; tools\nT1 P7 D0.5 Z+1.25 ; mill\n\nq9 X-1 t2 P2 d.25 I10 J20\n", 25.4));
  EXPECT_EQ(table.at(1).pocket, 7);
  EXPECT_DOUBLE_EQ(table.at(1).diameter_mm, 12.7);
  EXPECT_DOUBLE_EQ(table.at(1).offset[2], 31.75);
  EXPECT_EQ(table.at(2).orientation, 9);
  EXPECT_DOUBLE_EQ(table.at(2).offset[0], -25.4);
}

TEST(ToolTable, ErrorsNameTheInvalidWord) {
  const auto error = [](const char* text) { return read_tool_table("t.tbl", text).error(); };
  EXPECT_EQ(error("T1\nT2 Dx\n").line, 2u);
  EXPECT_EQ(error("T1\nT2 Dx\n").word, "Dx");
  EXPECT_THAT(error("T1\nT1\n").reason, HasSubstr("twice"));
  EXPECT_THAT(error("P1\n").reason, HasSubstr("T word"));
  EXPECT_THAT(error("T0.5\n").reason, HasSubstr("integer"));
  EXPECT_THAT(error("T1 W2\n").reason, HasSubstr("not supported"));
  EXPECT_THAT(error("T1 Dnan\n").reason, HasSubstr("number"));
}

TEST(ParameterFile, ReadsLinesOfTwoNumbersInAscendingOrder) {
  const auto parameters =
      test::value_of(read_parameter_file("p.var", "5161 1.5\nname value\n5221\t-2e1\n\n"));
  EXPECT_EQ(parameters, (std::map<int, double>{{5161, 1.5}, {5221, -20}}));
  EXPECT_THAT(read_parameter_file("p.var", "5221 0\n5161 0\n").error().reason,
              HasSubstr("greater than the parameter number before it, 5221"));
  EXPECT_THAT(read_parameter_file("p.var", "9999 0\n").error().reason, HasSubstr("from 1 to 5601"));
}

TEST(GcodeEnvironment, ToolOffsetsShiftProgrammedCoordinates) {
  // The controlled point does not move. Its coordinates shift by the tool length.
  EXPECT_EQ(moves_of("T2 M6\nG0 X0 Y0 Z50\nG43\nG91 G0 X1\nG49\nX1\nM2\n"),
            "R 0 0 50, R 1 0 30, R 2 0 50");
  EXPECT_EQ(moves_of("T1 M6\nG0 Z50\nG43 H3\nG91 G0 X1\nG43.2 H1\nX1\nG43.1 Z5\nX1\nM2\n"),
            "R 0 0 50, R 1 0 20, R 2 0 10, R 3 0 45");
  EXPECT_EQ(moves_of("G10 L1 P1 Z7 R2\nT1 M6\nG0 X#5403 Y#5410 Z#5400\nM2\n"), "R 7 4 1");
  EXPECT_THAT(run_error_of("G43 H9\nM2\n").reason, HasSubstr("tool table has no tool 9"));
}

TEST(GcodeEnvironment, WithoutG43TheToolCutsDeeperByItsLength) {
  const Scene scene = scene_for("xyz");
  GcodeEnvironment environment{.tools = test::three_tools()};
  const auto depth = [&](const std::string& text) {
    const auto program = parse_program("p.ngc", text, scene, environment);
    EXPECT_TRUE(program.has_value()) << to_string(program.error());
    return program->motions.back().to.tip_mm.z;
  };
  EXPECT_EQ(depth("T1 M6\nG43\nG0 X0 Y0 Z5\nG1 Z-1 F100\nM2\n"), -1);
  EXPECT_EQ(depth("T1 M6\nG0 X0 Y0 Z15\nG1 Z-1 F100\nM2\n"), -11);
  EXPECT_EQ(depth("T1 M6\nG43 H2\nG0 X0 Y0 Z15\nG1 Z-1 F100\nM2\n"), 9);
}

TEST(GcodeEnvironment, MachineZeroIsKnownWithParameterFile) {
  const Scene scene = scene_for("xyz");
  GcodeEnvironment environment;
  environment.parameters =
      std::map<int, double>{{5161, 0}, {5163, 100}, {5221, 10}, {5222, 20}, {5223, 30}, {5241, 15}};
  const auto program = test::value_of(
      parse_program("p.ngc", "T1 M6\nG0 X0 Y0 Z5\nG1 Z-1 F100\nG53 G0 Z40\nG28\nG55 G0 X0\nM2\n",
                    scene, environment));
  std::vector<Vec3> ends;
  for (const ProgramMotion& motion : program.motions) ends.push_back(motion.to.tip_mm);
  // The scene's origin is that of G54. Other positions follow from the machine zero.
  EXPECT_THAT(ends, testing::ElementsAre(Vec3{0, 0, -1}, Vec3{0, 0, 10}, Vec3{-10, -20, 70},
                                         Vec3{5, -20, 70}));
  EXPECT_THAT(program.warnings, IsEmpty());
}

TEST(GcodeEnvironment, PredefinedParametersReportTheState) {
  EXPECT_EQ(moves_of("G20\nG0 X1\nG21\nG10 L2 P2 X5\nG55\nG0 X#<_abs_x> Y[#<_x>+#<_metric>] "
                     "Z#<_coord_system>\nM2\n"),
            "R 25.4 0 0, R 30.4 21.4 550");
  EXPECT_EQ(
      moves_of("F12 S34 T2\nG0 X#<_feed> Y#<_rpm> Z#<_selected_tool>\nG0 X#<_line> Y#<_plane> "
               "Z#<_motion_mode>\nM2\n"),
      "R 12 34 2, R 3 170 0");
}

TEST(GcodeEnvironment, RotatedCoordinateSystemsAndPolarCoordinatesWork) {
  EXPECT_EQ(moves_of("G10 L2 P1 X10 R90\nG0 X5 Y0\nG0 @2 ^90\nM2\n"), "R 10 5 0, R 8 0 0");
  EXPECT_EQ(moves_of("G0 @5 ^90\n@3\nG91 ^-90\nM2\n"), "R 0 5 0, R 0 3 0, R 3 0 0");
  EXPECT_THAT(run_error_of("G0 @5\nM2\n").reason, HasSubstr("origin"));
  EXPECT_THAT(run_error_of("G18\nG0 @5 ^3\nM2\n").reason, HasSubstr("plane XY"));
}

TEST(GcodeEnvironment, HomePositionsAndShiftsWork) {
  EXPECT_EQ(moves_of("G0 X1 Y2 Z3\nG28.1\nG0 X9\nG28 X5\nG30\nM2\n"),
            "R 1 2 3, R 9 2 3, R 5 2 3, R 1 2 3, R 1 2 3, R 0 0 0");
  EXPECT_EQ(moves_of("G52 X10\nG0 X1\nG52 X0\nG0 X1\nM2\n"), "R 11 0 0, R 1 0 0");
}

TEST(GcodeEnvironment, SplinesReachTheirEndsWithinTolerance) {
  EXPECT_EQ(moves_of("F100\nG5.1 X10 Y0 I5 J5\nG5 X20 Y0 I1 J2 P-1 Q2\nX30 Y0 P0 Q1\nM2\n"),
            "S 10 0 0, S 20 0 0, S 30 0 0");
  const Program program =
      test::gcode(scene_for("xyz", 0.001), "T1 M6\nG0 X0 Y0 Z0\nG5.1 X10 Y0 I5 J5 F600\nM2\n");
  double length_mm = 0, duration_s = 0;
  for (const ProgramMotion& m : program.motions) {
    // The parabola y = x - x²/10.
    EXPECT_NEAR(m.to.tip_mm.y, m.to.tip_mm.x - m.to.tip_mm.x * m.to.tip_mm.x / 10, 1e-5);
    length_mm += length(m.to.tip_mm - m.from.tip_mm);
    duration_s += m.duration_s;
  }
  EXPECT_NEAR(length_mm, 5 * (std::sqrt(2) + std::log(1 + std::sqrt(2))), 0.002);
  EXPECT_NEAR(duration_s, length_mm / 10, 0.001);
}

}  // namespace
}  // namespace kerf::gcode_environment_test
