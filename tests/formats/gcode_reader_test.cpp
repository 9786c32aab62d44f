// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/carved_volume.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::gcode_reader_test {
namespace {

using test::error_of;
using test::gcode;
using test::scene_for;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kStart = "G21 G90 G94 T1 M6\nG0 X0 Y0 Z5\n";

std::vector<Vec3> ends(const Program& program) {
  std::vector<Vec3> tips;
  for (const ProgramMotion& motion : program.motions) tips.push_back(motion.to.tip_mm);
  return tips;
}

TEST(GcodeReader, BlocksBecomeMotionsWithLineToolAndDuration) {
  const Program program = gcode(scene_for("xyz"), kStart + "G1 X30 F600\nY40 Z5\n\nG0 Z10\nM2\n");
  ASSERT_EQ(program.motions.size(), 3u);
  EXPECT_EQ(program.motions[0],
            (ProgramMotion{1, {{0, 0, 5}, {0, 0, 1}}, {{30, 0, 5}, {0, 0, 1}}, 3.0, 3, false}));
  EXPECT_EQ(program.motions[1].duration_s, 4);
  EXPECT_EQ(program.motions[2].line, 6u);
  EXPECT_TRUE(program.motions[2].rapid);
  EXPECT_EQ(program.motions[2].duration_s, 60 * 5 / 10000.0);
  EXPECT_THAT(program.warnings, IsEmpty());
}

TEST(GcodeReader, RapidsBeforeTheFirstCutPlaceTheToolWithoutMotion) {
  // A straight path to X-40 would cross the block. A real tool comes from its changer.
  const Program program =
      gcode(scene_for("xyz"), "T1 M6\nG0 Z20\nX-40 Y3\nZ-5\nG1 X-30 F100\nM2\n");
  ASSERT_EQ(program.motions.size(), 2u);
  EXPECT_EQ(program.motions[0].from.tip_mm, (Vec3{-40, 3, 20}));
  EXPECT_EQ(program.motions[0].to.tip_mm, (Vec3{-40, 3, -5}));
}

TEST(GcodeReader, ToolPlacedInStockRemovesTheSameWithAMicrometerOfTravel) {
  const Scene scene = scene_for("xyz");
  const std::string placed = "G21 G90 T1 M6\nG0 X0 Y0 Z-2\n", again = "G1 X0 Y0 Z-2 F100\n";
  const Program none = gcode(scene, placed + "M2\n");
  const Program still = gcode(scene, placed + again + again + "G0 Z-2\nM2\n");
  const Program moved = gcode(scene, placed + "G1 X0.001 F100\nM2\n");
  EXPECT_EQ(none.motions.size(), 0U);
  ASSERT_EQ(still.motions.size(), 1U) << "where it has been there is nothing left";
  EXPECT_EQ(still.motions[0].from, still.motions[0].to);
  const double taken = test::removed_mm3(scene, moved);
  EXPECT_GT(taken, 1);
  EXPECT_NEAR(test::removed_mm3(scene, still), taken, 0.05);
  // Another tool at the same position. A rapid to the same position is no motion.
  const std::string other = placed + again + "T2 M6\n";
  EXPECT_EQ(gcode(scene, other + again + again + "M2\n").motions.size(), 2U);
  EXPECT_EQ(gcode(scene, other + "G0 X0 Y0\nM2\n").motions.size(), 1U);
}

TEST(GcodeReader, WarnsOfACutBeforeAllAxesAreKnown) {
  const Program program = gcode(scene_for("xyz"), "T1 M6\nG0 X1 Y2\nG1 Z-1 F100\nM2\n");
  ASSERT_EQ(program.motions.size(), 1u);
  EXPECT_EQ(program.motions[0].from.tip_mm, (Vec3{1, 2, 0}));
  EXPECT_THAT(program.warnings, ElementsAre(HasSubstr("p.ngc:3: X, Y and Z")));
}

TEST(GcodeReader, ToolIsAwayAfterMachineCoordinates) {
  const Program program =
      gcode(scene_for("xyz"), kStart +
                                  "G1 Z-5 F100\nG53 G0 Z0\nG0 X10 Y10\nZ-5\nG1 X11\nG28 Z8\nG0 "
                                  "X0\nG30\nG0 X1 Y1 Z1\nG1 X2\nM2\n");
  EXPECT_THAT(ends(program),
              ElementsAre(Vec3{0, 0, -5}, Vec3{11, 10, -5}, Vec3{11, 10, 8}, Vec3{2, 1, 1}));
  EXPECT_EQ(program.motions[1].from.tip_mm, (Vec3{10, 10, -5}));
}

TEST(GcodeReader, UnitsDistanceModesAndWorkOffsetsApply) {
  const Scene scene = scene_for("xyz");
  EXPECT_THAT(ends(gcode(scene, kStart + "G20 G1 X1 F10\nG21 X1\nM2\n")),
              ElementsAre(Vec3{25.4, 0, 5}, Vec3{1, 0, 5}));
  EXPECT_THAT(ends(gcode(scene, kStart + "G91 G1 X1 Z-1 F10\nX1\nG90 X1\nM2\n")),
              ElementsAre(Vec3{1, 0, 4}, Vec3{2, 0, 4}, Vec3{1, 0, 4}));
  EXPECT_THAT(ends(gcode(scene, kStart + "G10 L2 P2 X10 Y20\nG55 G1 X1 Y1 F10\nG54 X1 Y1\nM2\n")),
              ElementsAre(Vec3{11, 21, 5}, Vec3{1, 1, 5}));
  EXPECT_THAT(ends(gcode(scene, kStart + "G10 L20 P1 X100\nG1 X101 F10\nM2\n")),
              ElementsAre(Vec3{1, 0, 5}));
  EXPECT_THAT(
      ends(gcode(scene,
                 kStart + "G92 X100 Z0\nG1 X101 Z1 F10\nG92.2\nX2\nG92.3\nX102\nG92.1 X3\nM2\n")),
      ElementsAre(Vec3{1, 0, 6}, Vec3{2, 0, 6}, Vec3{3, 0, 6}));
  EXPECT_THAT(ends(gcode(scene, kStart + "G1 X1 F10\nX[#5420+1]\n#1=#5420\nX[#1+#5422]\nM2\n")),
              ElementsAre(Vec3{1, 0, 5}, Vec3{2, 0, 5}, Vec3{7, 0, 5}));
  EXPECT_THAT(ends(gcode(scene, kStart + "G59.3 G1 X1 F10\n#1=#5220\nX#1\nM2\n")),
              ElementsAre(Vec3{1, 0, 5}, Vec3{9, 0, 5}));
}

TEST(GcodeReader, FeedModesDetermineDurations) {
  const Scene scene = scene_for("xyz");
  EXPECT_EQ(gcode(scene, kStart + "G93 G1 X10 F2\nM2\n").motions[0].duration_s, 30);
  EXPECT_EQ(gcode(scene, kStart + "S100 M3 G95 G1 X10 F0.5\nM2\n").motions[0].duration_s, 12);
  EXPECT_NEAR(gcode(scene, kStart + "G20\nG1 X1 F60\nM2\n").motions[0].duration_s, 1, 1e-12);
  // F is executed before G20, as in LinuxCNC.
  const Program early = gcode(scene, kStart + "G20 G1 X1 F60\nM2\n");
  EXPECT_NEAR(early.motions[0].duration_s, 25.4, 1e-12);
  EXPECT_THAT(early.warnings, ElementsAre(HasSubstr("units before this block")));
}

TEST(GcodeReader, DwellIsAMotionAtRest) {
  const Program program = gcode(scene_for("xyz"), kStart + "G4 P1.5\nM2\n");
  ASSERT_EQ(program.motions.size(), 1u);
  EXPECT_EQ(program.motions[0].from, program.motions[0].to);
  EXPECT_EQ(program.motions[0].duration_s, 1.5);
}

TEST(GcodeReader, ToolChangeAppliesFromM6On) {
  const Program program = gcode(scene_for("xyz"), kStart + "G1 Z0 F10\nT2\nZ1\nM6\nZ2\nM2\n");
  ASSERT_EQ(program.motions.size(), 3u);
  EXPECT_EQ(program.motions[1].tool, 1u);
  EXPECT_EQ(program.motions[2].tool, 2u);
}

TEST(GcodeReader, OnlyToolOfASceneNeedsNoToolChange) {
  auto scene = scene_for("xyz");
  EXPECT_THAT(error_of(scene, "p.ngc", "G1 X1 F10\nM2\n").reason, HasSubstr("no tool is loaded"));
  scene.tools.erase(2);
  const Program program = gcode(scene, "G0 X0 Y0 Z1\nG1 Z0 F10\nM2\n");
  EXPECT_EQ(program.motions.size(), 1u);
  EXPECT_THAT(program.warnings, ElementsAre(HasSubstr("only tool")));
}

TEST(GcodeReader, ProgramThatOnlySelectsT0UsesTheOnlyTool) {
  Scene scene = scene_for("xyz");
  scene.tools.erase(2);
  const std::string body = "G0 X0 Y0 Z5\nG1 Z-1 F100\nX9\nM2\n";
  EXPECT_TRUE(gcode(scene, "G21\nT0 M6\n" + body).motions ==
              gcode(scene, "G21\nT1 M6\n" + body).motions);
  EXPECT_THAT(error_of(scene, "p.ngc", "G21\nT1 M6\nT0 M6\n" + body).reason,
              HasSubstr("no tool is loaded"));
}

TEST(GcodeReader, PercentSignsFrameTheProgram) {
  const Scene scene = scene_for("xyz");
  EXPECT_THAT(gcode(scene, "%\n" + kStart + "G1 Z0 F10\n%\nnonsense\n").warnings,
              ElementsAre(HasSubstr("lines after the end")));
  EXPECT_THAT(gcode(scene, "%\n" + kStart + "G1 Z0 F10\nM30\n%\n").warnings, IsEmpty());
  EXPECT_THAT(gcode(scene, kStart + "G1 Z0 F10").warnings, ElementsAre(HasSubstr("without M2")));
  EXPECT_EQ(gcode(scene, "").motions.size(), 0u);
  EXPECT_EQ(gcode(scene, "\xEF\xBB\xBF%\n" + kStart + "G1 Z0 F10\n%\n").motions.size(), 1u);
  EXPECT_EQ(gcode(scene, kStart + "\r\nG1 Z0 F10\r\nM2\r\n").motions.size(), 1u);
  EXPECT_EQ(gcode(scene, "(a comment before it)\n%\n" + kStart + "G1 Z0 F10\n%\n").motions.size(),
            1u);
}

TEST(GcodeReader, BlockDeleteIsOn) {
  EXPECT_THAT(ends(gcode(scene_for("xyz"), kStart + "G1 F10 X1\n/X2\nX3\nM2\n")),
              ElementsAre(Vec3{1, 0, 5}, Vec3{3, 0, 5}));
}

struct BadProgram {
  const char* text;
  std::size_t line;
  const char* word;
  const char* reason;
};

class BadGcode : public testing::TestWithParam<BadProgram> {};

TEST_P(BadGcode, IsRejectedWithLineAndWord) {
  const BadProgram& bad = GetParam();
  const ProgramError error = error_of(scene_for("xyz"), "p.ngc", kStart + bad.text + "\nM2\n");
  EXPECT_EQ(error.file, "p.ngc");
  EXPECT_EQ(error.line, bad.line) << error.reason;
  EXPECT_EQ(error.word, bad.word) << error.reason;
  EXPECT_THAT(error.reason, HasSubstr(bad.reason));
}

INSTANTIATE_TEST_SUITE_P(
    GcodeReader, BadGcode,
    testing::Values(
        BadProgram{"G1 X1", 3, "G1 X1", "feed is 0"},
        BadProgram{"G1 X1 F0", 3, "G1 X1 F0", "feed is 0"},
        BadProgram{"G1 X1 F-1", 3, "F-1", "negative"},
        BadProgram{"F100\nG93 G1 X1 F1\nX2", 5, "X2", "inverse time"},
        BadProgram{"G93 G1 X1 F1\nG94 X2", 4, "G94 X2", "feed is 0"},
        BadProgram{"G95 G1 X1 F1", 3, "G95 G1 X1 F1", "spindle speed"},
        BadProgram{"G1 F100\nG80 X1", 4, "G80", "no axis words"},
        BadProgram{"G80\nX1", 4, "X1", "motion code"},
        BadProgram{"G1 A5 F1", 3, "A5", "has no A axis"},
        BadProgram{"G1 X1 I0 J0 K1 F1", 3, "I0", "not used by any code"},
        BadProgram{"G83 Z-5 R1 Q1", 3, "G83 Z-5 R1 Q1", "feed is 0"},
        BadProgram{"M100", 3, "M100", "user-defined M code"},
        BadProgram{"T3", 3, "T3", "no tool 3"}, BadProgram{"T-1", 3, "T-1", "integer"},
        BadProgram{"T1.5", 3, "T1.5", "integer"}, BadProgram{"S-5", 3, "S-5", "negative"},
        BadProgram{"G4", 3, "G4", "requires P"}, BadProgram{"G4 P-1", 3, "G4", "requires P"},
        BadProgram{"P5", 3, "P5", "not used by any code"},
        BadProgram{"H1", 3, "H1", "not used by any code"},
        BadProgram{"G10 L3 P1 X0", 3, "G10", "requires L1, L2"},
        BadProgram{"G10 L2 X0", 3, "G10", "requires P"},
        BadProgram{"G10 L2 P12 X0", 3, "P12", "from 0 to 9"},
        BadProgram{"G10 L20 P1 R5", 3, "R5", "not used by any code"},
        BadProgram{"G92", 3, "G92", "axis word"},
        BadProgram{"G92 G1 X5 F10", 3, "G92", "must not have a motion code"},
        BadProgram{"G53 G1 Z0 F10", 3, "G53", "requires G0"},
        BadProgram{"G1 X1e5 F10", 3, "E5", "not used by any code"},
        BadProgram{"G1 X1000001 F10", 3, "G1 X1000001 F10", "limit"},
        BadProgram{"G1 X1 F0.00000000001", 3, "G1 X1 F0.00000000001", "take longer than"},
        BadProgram{"o100 call", 3, "O100 CALL",
                   "neither in the program nor in a subroutine folder"},
        BadProgram{"G1 X#<speed> F1", 3, "#<speed>", "not assigned"},
        BadProgram{"(open", 3, "(open", "not closed"},
        BadProgram{"#5420=1", 3, "#5420", "read-only"}));

TEST(GcodeReader, ToolChangeRequiresASelectedTool) {
  EXPECT_EQ(error_of(scene_for("xyz"), "p.ngc", "M6\n").word, "M6");
  EXPECT_THAT(error_of(scene_for("xyz"), "p.ngc", kStart + "T0 M6\nG1 X1 F1\n").reason,
              HasSubstr("no tool is loaded"));
}

TEST(GcodeReader, WarnsOfAnotherToolsLength) {
  EXPECT_THAT(gcode(scene_for("xyz"), kStart + "G43 H2\nG43 H1\nG49\nM2\n").warnings,
              testing::Contains(HasSubstr("H2 is the length of another tool")));
}

TEST(GcodeReader, ReportsFirstThatAProgramCutsNothing) {
  const auto warnings = [](const std::string& text) {
    return gcode(scene_for("xyz"), text).warnings;
  };
  EXPECT_THAT(
      warnings(kStart + "G43 H2\nG0 X1 Y1 Z1\nZ0\nM2\n"),
      ElementsAre(HasSubstr("THE PROGRAM CUTS NOTHING: it ends after 6 lines"), HasSubstr("H2")));
  EXPECT_THAT(warnings("M2\n"), ElementsAre(HasSubstr("CUTS NOTHING")));
  EXPECT_THAT(warnings(kStart + "G0 X1 Y1 Z1\nG1 Z0 F100\nM2\n"), testing::IsEmpty());
}

TEST(ProgramFormat, IsDeterminedByTheExtension) {
  EXPECT_EQ(program_format("a.b/part.NGC").value(), ProgramFormat::kGcode);
  EXPECT_EQ(program_format("part.nc").value(), ProgramFormat::kGcode);
  EXPECT_EQ(program_format("part.cls").value(), ProgramFormat::kApt);
  EXPECT_FALSE(program_format("part.stl").has_value());
  EXPECT_FALSE(program_format("ngc").has_value());
}

TEST(ProgramError, IsOneLineWithoutControlCharacters) {
  EXPECT_EQ(to_string(ProgramError{"p.ngc", 3, "X\x1b[1m\n", "is bad"}),
            "p.ngc:3: 'X?[1m?' is bad");
  EXPECT_LT(to_string(ProgramError{"p", 1, std::string(9999, 'x'), "r"}).size(), 100u);
}

}  // namespace
}  // namespace kerf::gcode_reader_test
