// SPDX-License-Identifier: Apache-2.0
// HEIDENHAIN Klartext, against paths computed by hand.
#include "server/formats/derived_scene.h"
#include "server/formats/heidenhain/blocks.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::klartext_test {
namespace {

using test::scene_for;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

const std::string kHead = "0 BEGIN PGM T MM\n1 TOOL CALL 1 Z S1000\n2 L X+0 Y+0 Z+5 R0 FMAX M3\n";

std::expected<Program, ProgramError> read(const std::string& text, const char* machine = "xyz") {
  return parse_program("p.h", text, scene_for(machine));
}

// Ends of the motions after the head, rounded to 0.001 mm.
std::vector<Vec3> ends(const std::string& body, const char* machine = "xyz") {
  const auto program = read(kHead + body + "END PGM T MM\n", machine);
  EXPECT_TRUE(program) << to_string(program.error());
  return program ? test::rounded_ends(*program) : std::vector<Vec3>{};
}

std::string refused(const std::string& body, const char* machine = "xyz") {
  const auto program = read(kHead + body, machine);
  return program ? "" : to_string(program.error());
}

TEST(Klartext, IsAlsoReadByName) {
  GcodeEnvironment environment{.dialect = *dialect_of("heidenhain")};
  const std::string text = "TOOL CALL 1 Z S1000\nL X+0 Y+0 Z+5 R0 FMAX\nL X+3 F100\n";
  const auto program = test::value_of(parse_program("p.nc", text, scene_for("xyz"), environment));
  EXPECT_EQ(program.motions.back().to.tip_mm, (Vec3{3, 0, 5}));
  EXPECT_FALSE(parse_program("p.nc", text, scene_for("xyz")));
}

// A square of 40 mm that a tool of 10 mm follows on the outside.
TEST(Klartext, CompensationStaysOutsideTheContour) {
  const auto path = ends(
      "L X+20 Y-30 R0 FMAX\nL Z-1 F500\nL X+20 Y+0 RR\nL X+40\nL Y+40\nL X+0\nL Y+0\nL X+20\n"
      "L Z+5 R0 FMAX\nL Y-30\n");
  double left = 0, right = 0, back = 0;
  for (const Vec3 p : path) {
    left = std::min(left, p.x);
    right = std::max(right, p.x);
    back = std::max(back, p.y);
  }
  EXPECT_NEAR(left, -5, 1e-9);
  EXPECT_NEAR(right, 45, 1e-9);
  EXPECT_NEAR(back, 45, 1e-9);
  // R0 alone leaves the tool next to the contour until it moves in X and Y.
  EXPECT_THAT(path, Contains(Vec3{20, -5, 5}));
  EXPECT_EQ(path.back(), (Vec3{20, -30, 5}));
}

TEST(Klartext, OldCyclesAndVectors) {
  EXPECT_THAT(
      ends("CYCL DEF 1.0 PECKING\nCYCL DEF 1.1 SET UP 2\nCYCL DEF 1.2 DEPTH -8\n"
           "CYCL DEF 1.3 PECKG 4\nCYCL DEF 1.4 DWELL 0\nCYCL DEF 1.5 F100\nL X+1 FMAX M99\n"),
      ElementsAre(Vec3{1, 0, 5}, Vec3{1, 0, -5}, Vec3{1, 0, 5}));
  EXPECT_THAT(ends("CYCL DEF 19.0 WORKING PLANE\nCYCL DEF 19.1\n"
                   "PLANE VECTOR BX1 BY0 BZ0 NX0 NY0 NZ1 STAY\nL X+1 F9\n"),
              ElementsAre(Vec3{1, 0, 5}));
  EXPECT_THAT(refused("CYCL DEF 19.0\nCYCL DEF 19.1 B+30\n"), HasSubstr("CYCL DEF 19"));
  // The plane's X is Y of the workpiece, its normal is X.
  EXPECT_THAT(ends("PLANE VECTOR BX0 BY1 BZ0 NX1 NY0 NZ0 TURN FMAX\nL X+1 Y+2 Z+3 FMAX\nL Z+2 F9\n",
                   "xyzbc-trt"),
              ElementsAre(Vec3{2, 1, 2}));
}

TEST(Klartext, NothingIsCutBeforeTheFirstTool) {
  const auto program = test::value_of(
      read("BEGIN PGM T MM\nL Z+6 R0 F2000\nTOOL CALL 1 Z S9\nL X+0 Y+0 F9\nL X+1\n"));
  EXPECT_THAT(program.motions, SizeIs(1));
}

TEST(Klartext, LinesAreAbsoluteOrIncremental) {
  EXPECT_THAT(ends("3 L Z-1 F100\n4 L IX+10 Y+5.5 R0\n5 L IX-2,5 IZ+1 FMAX ; back\n* - title\n"),
              ElementsAre(Vec3{0, 0, -1}, Vec3{10, 5.5, -1}, Vec3{7.5, 5.5, 0}));
  const auto program =
      test::value_of(read("BEGIN PGM T INCH\nTOOL CALL 1 Z\nL X0 Y0 Z1 FMAX\nL X+2 F10\n"));
  EXPECT_NEAR(program.motions.at(0).to.tip_mm.x, 50.8, 1e-6);
  EXPECT_NEAR(program.motions.at(0).duration_s, 12, 1e-6);
}

TEST(Klartext, ArcsGoAboutThePole) {
  const auto quarter = ends("L X+10 F100\nCC X+0 Y+0\nC X+0 Y+10 DR+\n");
  EXPECT_EQ(quarter.back(), (Vec3{0, 10, 5}));
  for (const Vec3& p : quarter) EXPECT_NEAR(std::hypot(p.x, p.y), 10, 2e-3);
  EXPECT_EQ(ends("L X+10 F100\nCC X+0 Y+0\nCP IPA-90 DR-\n").back(), (Vec3{0, -10, 5}));
  EXPECT_EQ(ends("L X+10 F100\nCC X+0 Y+0\nCP PA+180 IZ-2 DR+\n").back(), (Vec3{-10, 0, 3}));
  EXPECT_EQ(ends("L X+10 F100\nCR X+0 Y+10 R+10 DR+\n").back(), (Vec3{0, 10, 5}));
  const auto most = ends("L X+10 F100\nCR X+0 Y+10 R-10 DR+\n");
  EXPECT_TRUE(std::ranges::any_of(most, [](Vec3 p) { return p.x > 15 && p.y > 10; }))
      << "about (10, 10)";
  EXPECT_EQ(ends("L X+10 F100\nCT X+20 Y+10\n").back(), (Vec3{20, 10, 5}));
  EXPECT_EQ(ends("L X+10 F100\nCC X+0 Y+0\nLP PR+20 PA+90\n").back(), (Vec3{0, 20, 5}));
  EXPECT_THAT(refused("L X+10 F100\nCC X+0 Y+0\nC X+0 Y+11 DR+\n"), HasSubstr("radius"));
  EXPECT_THAT(refused("L X+10 F100\nCC X+0 Y+0\nCP IPA+90 DR-\n"), HasSubstr("against DR"));
}

TEST(Klartext, RampOfAPostprocessorRollsIntoTheCut) {
  // The center is below, in the plane of X and Z: from (8, 7) down to (0, -1).
  const auto path = ends("L X+8 Z+7 FMAX\nCC X+0 Z+7\nCP IPA+90 DR+ F1000\n");
  EXPECT_EQ(path.back(), (Vec3{0, 0, -1}));
  for (std::size_t i = 1; i < path.size(); ++i)
    EXPECT_NEAR(std::hypot(path[i].x, path[i].z - 7), 8, 2e-3);
}

TEST(Klartext, HelixTurnsWholeTurns) {
  const auto path = ends("L X+10 F100\nCC X+0 Y+0\nCP IPA+720 IZ-4 DR+\n");
  EXPECT_EQ(path.back(), (Vec3{10, 0, 1}));
  int crossings = 0;
  for (std::size_t i = 1; i < path.size(); ++i) crossings += path[i - 1].y < 0 && path[i].y >= 0;
  EXPECT_EQ(crossings, 2);
}

TEST(Klartext, RoundsAndCutsCorners) {
  const auto round = ends("L X+20 F100\nRND R5\nL Y+20\n");
  EXPECT_EQ(round.front(), (Vec3{15, 0, 5}));
  EXPECT_EQ(round.back(), (Vec3{20, 20, 5}));
  EXPECT_EQ(round.at(round.size() - 2), (Vec3{20, 5, 5}));
  EXPECT_THAT(ends("L X+20 F100\nCHF 5\nL Y+20\n"),
              ElementsAre(Vec3{15, 0, 5}, Vec3{20, 5, 5}, Vec3{20, 20, 5}));
  EXPECT_THAT(refused("L X+20 F100\nRND R5\nEND PGM T MM\n"), HasSubstr("followed by a straight"));
  EXPECT_THAT(refused("L X+2 F100\nRND R5\nL Y+20\n"), HasSubstr("does not fit"));
}

TEST(Klartext, LabelsAreCalledAndRepeated) {
  EXPECT_THAT(ends("LBL 1\nL IX+1 F100\nLBL 0\nCALL LBL 1 REP 2/2\nL Y+1\n"),
              ElementsAre(Vec3{1, 0, 5}, Vec3{2, 0, 5}, Vec3{3, 0, 5}, Vec3{3, 1, 5}));
  EXPECT_THAT(ends("L Z+1 F9\nCALL LBL \"A\"\nCALL LBL \"A\"\nM30\nLBL \"A\"\nL IX+1\nLBL 0\n"),
              ElementsAre(Vec3{0, 0, 1}, Vec3{1, 0, 1}, Vec3{2, 0, 1}));
  EXPECT_THAT(refused("CALL LBL 7\n"), HasSubstr("does not exist"));
  EXPECT_THAT(refused("LBL 1\nCALL LBL 1\n"), HasSubstr("nested deeper"));
  GcodeEnvironment bounded{.lines_max = 1000};
  const auto endless = parse_program(
      "p.h", kHead + "LBL 1\nQ1 = 1\nFN 9: IF +Q1 EQU +1 GOTO LBL 1\n", scene_for("xyz"), bounded);
  EXPECT_THAT(endless.error().reason, HasSubstr("more than 1000 blocks"));
}

TEST(Klartext, ParametersAndFunctionsCompute) {
  EXPECT_THAT(ends("FN 0: Q1 = +10\nFN 2: Q2 = +Q1 - +4\nQ3 = SQRT ( Q1 * 2 + 5 ) / 5 ^ 1\n"
                   "Q4 = 3 + 4 * SIN 30 - -1\nL X+Q1 Y-Q2 FQ1\nL X+Q3 Y+Q4\n"),
              ElementsAre(Vec3{10, -6, 5}, Vec3{1, 6, 5}));
  EXPECT_THAT(ends("Q1 = 0\nLBL 5\nQ1 = Q1 + 1\nL X+Q1 F9\nFN 12: IF +Q1 LT +3 GOTO LBL 5\n"),
              ElementsAre(Vec3{1, 0, 5}, Vec3{2, 0, 5}, Vec3{3, 0, 5}));
  EXPECT_THAT(refused("L X+Q9 F9\n"), HasSubstr("'Q9' has no value"));
  EXPECT_THAT(refused("Q1 = 1 / 0\n"), HasSubstr("finite"));
}

TEST(Klartext, DatumShiftAndRotationMoveTheProgram) {
  EXPECT_THAT(ends("CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+10\nCYCL DEF 7.2 Y+20\nL X+1 Y+0 F9\n"
                   "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+90\nL X+1 Y+0\n"
                   "CYCL DEF 10.1 ROT+0\nCYCL DEF 7.1 IX-10 Y+0\nL X+1 Y+0\n"),
              ElementsAre(Vec3{11, 20, 5}, Vec3{10, 21, 5}, Vec3{1, 0, 5}));
}

TEST(Klartext, DrillsWhereACycleIsCalled) {
  EXPECT_THAT(ends("CYCL DEF 200 DRILLING ~\n  Q200=+2 ;SET-UP ~\n  Q201=-7 ;DEPTH ~\n"
                   "  Q206=+30 ;FEED ~\n  Q203=+1 ;SURFACE ~\n  Q204=+11 ;2ND\nL X+10 FMAX M99\n"
                   "L Y+3 FMAX\n"),
              ElementsAre(Vec3{10, 0, 5}, Vec3{10, 0, 3}, Vec3{10, 0, -6}, Vec3{10, 0, 12},
                          Vec3{10, 3, 12}));
  EXPECT_THAT(refused("L X+1 FMAX M99\n"), HasSubstr("not defined"));
  EXPECT_THAT(refused("CYCL DEF 251 POCKET ~\n Q218=10\n"), HasSubstr("CYCL DEF 251"));
}

TEST(Klartext, TheToolIsAwayAfterMachineCoordinates) {
  const auto path = ends("L Z-1 F100\nL Z-1 R0 FMAX M91\nL X+50 R0 FMAX\nL Z+2 FMAX\nL Z-1\n");
  EXPECT_THAT(path, ElementsAre(Vec3{0, 0, -1}, Vec3{50, 0, -1}));
  EXPECT_THAT(ends("L Z-1 F100\nL M140 MB MAX\nL X+50 FMAX\nL Z+2 FMAX\nL Z-1\n"),
              ElementsAre(Vec3{0, 0, -1}, Vec3{50, 0, -1}));
}

TEST(Klartext, PlaneSpatialTurnsTheCoordinatesAndTheTool) {
  const auto program = test::value_of(
      read(kHead + "L Z+50 FMAX\nPLANE SPATIAL SPA+90 SPB+0 SPC+0 TURN MB MAX FMAX\n"
                   "L X+1 Y+2 Z+3 FMAX\nL Z+0 F9\nPLANE RESET TURN\nL X0 Y0 Z9 FMAX\n"
                   "L Z+8 F9\nEND PGM T MM\n",
           "xyzac-trt"));
  const ProgramMotion& tilted = program.motions.at(1);
  // X stays. The plane's Y is Z, and its Z is -Y.
  EXPECT_NEAR(tilted.from.tip_mm.x, 1, 1e-6);
  EXPECT_NEAR(tilted.from.tip_mm.y, -3, 1e-6);
  EXPECT_NEAR(tilted.from.tip_mm.z, 2, 1e-6);
  EXPECT_NEAR(tilted.to.tip_mm.y, 0, 1e-6);
  EXPECT_NEAR(tilted.to.axis.y, -1, 1e-9);
  EXPECT_EQ(program.motions.back().to.axis, (Vec3{0, 0, 1}));
  EXPECT_THAT(refused("PLANE SPATIAL SPA+0 SPB+30 SPC+0 TURN\n"), HasSubstr("machine xyz"));
}

TEST(Klartext, M128KeepsTheTipWhileAxesTurn) {
  const auto program =
      test::value_of(read(kHead + "M128\nL A+30 F100\nEND PGM T MM\n", "xyzac-trt"));
  EXPECT_EQ(program.motions.back().to.tip_mm, (Vec3{0, 0, 5}));
  EXPECT_NEAR(program.motions.back().to.axis.z, std::cos(std::acos(-1.0) / 6), 1e-9);
}

// The angle by which the tool axis turns about Z at feed on a trunnion, deg.
double turned(const std::string& body) {
  const auto program = read(kHead + body + "END PGM T MM\n", "xyzac-trt");
  EXPECT_TRUE(program) << to_string(program.error());
  double sum = 0;
  if (program)
    for (const ProgramMotion& motion : program->motions) {
      const Vec3 a = motion.from.axis, b = motion.to.axis;
      if (motion.rapid) continue;
      const double turn = std::atan2(b.y, b.x) - std::atan2(a.y, a.x);
      sum += std::remainder(turn, 2 * std::numbers::pi) * 180 / std::numbers::pi;
    }
  return sum;
}

TEST(Klartext, M126TurnsTheShorterPath) {
  // The tool axis turns relative to the table, here in addition to C.
  const std::string from = "L A+30 C+350 FMAX\nM128\nL Z+1 F100\n";
  EXPECT_NEAR(turned(from + "L C+10\n"), 340, 1e-3) << "the other sign of C";
  EXPECT_NEAR(turned(from + "M126\nL C+10\n"), -20, 1e-3);
  EXPECT_NEAR(turned(from + "M126\nL C+10\nL C+340\n"), 10, 1e-3);
  EXPECT_NEAR(turned(from + "M126\nL C+10\nM127\nL C+340\n"), -350, 1e-3);
  EXPECT_NEAR(turned(from + "M126\nL IC+20\n"), -20, 1e-3);
  EXPECT_THAT(refused(from + "M126\nL IC+270\n", "xyzac-trt"), HasSubstr("M126"));
}

TEST(Klartext, M94RemovesWholeTurnsFromAnAngle) {
  const std::string from = "L A+30 C+538 FMAX\nM128\nL Z+1 F100\n";
  EXPECT_NEAR(turned(from + "L C+180\n"), 358, 1e-3);
  for (const char* reduced : {"M94\nL C+180\n", "M94 C\nL C+180\n", "L C+180 M94\n"})
    EXPECT_NEAR(turned(from + reduced), -2, 1e-3) << reduced;
  EXPECT_NEAR(turned(from + "M94 A\nL C+180\n"), 358, 1e-3);
  EXPECT_NEAR(turned("L A+30 C-182 FMAX\nM128\nL Z+1 F100\nM94\nL C+180\n"), -2, 1e-3);
}

TEST(Klartext, TablesTurnInMachineCoordinates) {
  for (const char* turn : {"L A+30 C+0 FMAX M91\n", "L Z+0 A+30 FMAX M91\nL Z+5 FMAX\n"}) {
    const auto program = test::value_of(read(kHead + turn + "M128\nL Z-1 F100\n", "xyzac-trt"));
    EXPECT_NEAR(program.motions.back().to.axis.z, std::cos(std::numbers::pi / 6), 1e-9) << turn;
  }
  for (const char* turn : {"L A+30 FMAX M92\n", "L IA+30 FMAX M91\n"})
    EXPECT_THAT(refused(turn, "xyzac-trt"), HasSubstr("is not supported")) << turn;
  EXPECT_THAT(refused("L A+30 FMAX M91\n"), HasSubstr("has no A axis"));
  EXPECT_THAT(refused("L X+9 F9\nRND R1\nL Z+0 FMAX M91\nL Y+9\n"), HasSubstr("'M91'"));
}

const std::string kDrill =
    "CYCL DEF 200 DRILLING ~\nQ200=2 ~\nQ201=-7 ~\nQ206=30 ~\nQ203=0 ~\nQ204=2\n";

// The positions of the holes.
std::vector<double> holes(const std::string& body) {
  std::vector<double> at;
  for (const Vec3& p : ends(kDrill + body))
    if (p.z == -7) at.push_back(p.x);
  return at;
}

TEST(Klartext, ACycleIsCalledUntilItsCallEnds) {
  EXPECT_THAT(holes("L X+10 FMAX\nM99\nL X+30 FMAX M99\nL X+40 FMAX\n"), ElementsAre(10, 30));
  EXPECT_THAT(holes("L X+1 FMAX\nM89\nL X+2 FMAX\nCC X+0 Y+0\nLP PR+3 PA+0 FMAX\n"
                    "L X+4 FMAX M99\nL X+5 FMAX\n"),
              ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(holes("L X+1 FMAX M89\nL X+2 FMAX\nCYCL CALL\nL X+3 FMAX\n"), ElementsAre(1, 2, 2));
  EXPECT_THAT(holes("L X+1 FMAX M89\n" + kDrill + "L X+2 FMAX\n"), ElementsAre(1));
  EXPECT_THAT(refused(kDrill + "L X+1 FMAX M91 M99\n"), HasSubstr("beside M91"));
  EXPECT_THAT(refused(kDrill + "L X+9 F9\nRND R1\nCYCL CALL\nL Y+9\n"), HasSubstr("RND"));
}

TEST(Klartext, HolesAreDrilledAlongTheAxisOrRejected) {
  const std::string turn = kDrill + "L A+30 FMAX\n";
  EXPECT_EQ(refused(turn + "L X+1 FMAX M99\n", "xyzac-trt"), "");
  EXPECT_EQ(refused(kDrill + "M128\nL X+1 C+90 FMAX M99\n", "xyzac-trt"), "");
  EXPECT_THAT(refused(turn + "M128\nL X+1 FMAX M99\n", "xyzac-trt"), HasSubstr("M128"));
  EXPECT_THAT(refused(turn + "M128\nM140 MB50\n", "xyzac-trt"), HasSubstr("M128"));
}

// Tool 1 has a radius of 5 mm. The path is that of a tool larger by DR.
TEST(Klartext, DrOfToolCallIsAddedToTheRadius) {
  const auto beside = [](const std::string& words) {
    return ends("TOOL CALL 1 Z S1000 " + words +
                "\nL X-30 Y+0 R0 F500\nL X-10 RL\nL X+20\nL R0 Y+30\n")
        .at(1)
        .y;
  };
  EXPECT_EQ(beside("DR+0"), 5);
  EXPECT_EQ(beside("DR+0.5"), 5.5);
  EXPECT_EQ(beside("DR-0.25"), 4.75);
  EXPECT_EQ(beside("DR+0.5\nTOOL CALL 1 Z"), 5) << "of the last TOOL CALL";
  EXPECT_THAT(refused("TOOL CALL 1 Z DR-9\nL X-30 R0 F500\nL X-10 RL\nL X+20\n"),
              HasSubstr("less than 0"));
}

TEST(Klartext, ToolCallWordsThatChangeTheToolAreRejected) {
  EXPECT_THAT(ends("TOOL CALL 1 Z S900 F50 DL+0 DR-0,0 DR2:+0\nL X+1\n"), SizeIs(1));
  EXPECT_THAT(ends("TOOL CALL 1 Z DR2+0\nL X+1 F9\n"), SizeIs(1));
  for (const char* word : {"DL+0.5", "DR2:+0.2", "DR2+0.1", "DR2", "DL", "U", "X", "FU1"})
    EXPECT_NE(refused(std::string("TOOL CALL 1 Z S1000 ") + word + "\nL X+1 F9\n"), "") << word;
}

TEST(Klartext, TcpmIsReadLikeM128Only) {
  const std::string tcpm = "FUNCTION TCPM F TCP AXIS ";
  EXPECT_EQ(refused(tcpm + "POS PATHCTRL AXIS REFPNT TIP-TIP\nL X+1 F9\n"), "");
  EXPECT_THAT(refused(tcpm + "SPAT PATHCTRL AXIS\n"), HasSubstr("AXIS SPAT"));
  EXPECT_THAT(refused(tcpm + "POS PATHCTRL VECTOR\n"), HasSubstr("PATHCTRL VECTOR"));
  EXPECT_THAT(refused(tcpm + "POS PATHCTRL AXIS REFPNT CENTER-CENTER\n"), HasSubstr("CENTER"));
}

TEST(Klartext, FeedOfACornerOrM128IsNotThePathFeed) {
  const auto program = test::value_of(read(kHead + "L X+20 F1000\nCHF 5 F50\nL Y+20\n"));
  std::vector<double> feeds;
  for (const ProgramMotion& motion : program.motions)
    feeds.push_back(
        std::round(60 * length(motion.to.tip_mm - motion.from.tip_mm) / motion.duration_s));
  EXPECT_THAT(feeds, ElementsAre(1000, 50, 1000));
  const auto compensated =
      test::value_of(read(kHead + "L X+20 F60 M128 F1000\nL X+21\nM128 F500\nL X+22\n"));
  for (const std::size_t i : {1U, 2U}) EXPECT_EQ(compensated.motions.at(i).duration_s, 1);
  EXPECT_THAT(refused("L X+20 F9\nRND R5 FMAX\nL Y+20\n"), HasSubstr("FMAX"));
}

TEST(Klartext, PolarLinesHaveCorners) {
  const auto path = ends("CC X+0 Y+0\nLP PR+20 PA+0 F500\nCHF 5\nLP IPR+0 IPA+90\n");
  const double back = std::round(5000 / std::sqrt(2)) / 1000;
  EXPECT_THAT(path, ElementsAre(Vec3{15, 0, 5}, Vec3{20 - back, back, 5}, Vec3{0, 20, 5}));
  EXPECT_THAT(refused("L X+20 F9\nRND R5\nTOOL CALL 1 Z\nL Y+20\n"), HasSubstr("between"));
  EXPECT_THAT(refused("L X+20 F9\nRND R5\nM140 MB5\nL Y+20\n"), HasSubstr("between"));
  EXPECT_THAT(refused("L X+20 A+9 F9\nRND R5\nL Y+20\n", "xyzac-trt"), HasSubstr("RND"));
}

TEST(Klartext, WordsMayContainBlanks) {
  const auto program = test::value_of(read(kHead + "L X+1 R0 F MAX M3\nL X+2 F AUTO F9\n"));
  EXPECT_TRUE(program.motions.at(0).rapid);
  for (const char* name : {"V.ZEIT 1.5", "DWELL 1,5"}) {
    const auto waits =
        test::value_of(read(kHead + "L X+1 F60\nCYCL DEF 9.0 X\nCYCL DEF 9.1 " + name + "\n"));
    EXPECT_EQ(waits.motions.back().duration_s, 1.5) << name;
  }
}

TEST(Klartext, UncertainWordsAreRejectedByName) {
  EXPECT_THAT(refused("L X+20 RL F9\nL X+40\nM128\n"), HasSubstr("ended with R0"));
  for (const char* text : {"APPR LT X+1 LEN15 RL\n", "FL X+1\n", "TCH PROBE 413 D ~\n Q1=1\n",
                           "CALL PGM X\n", "LN X+1 NX0 NY0 NZ1 F9\n", "FN 18: SYSREAD Q1 = ID1\n",
                           "PLANE VECTOR BX1\n", "CYCL DEF 8.1 X\n", "L C+10 F9\n", "L U+1 F9\n",
                           "M99999999999\n", "CC X+0 Y+0\nLP PR+9 PA+9 FMAX M91\n"})
    EXPECT_NE(refused(text), "") << text;
  EXPECT_THAT(refused("L X+1\n"), HasSubstr("feed is missing"));
}

TEST(Klartext, TheBlankIsTheStock) {
  const auto scene = test::value_of(derive_scene(
      "p.h",
      "0 BEGIN PGM T MM\n1 BLK FORM 0.1 Z X-10 Y-20 Z-30\n2 BLK FORM 0.2 X+40 IY+50 Z+1\n"
      "3 ;T2 D=+8 CR=+0 - ZMIN=-15 - flat end mill\n4 TOOL CALL 2 Z S1000\n"
      "5 L X+0 Y+0 Z+5 FMAX\n6 L Z-1 F100\n7 L X+30\n8 END PGM T MM\n",
      {}, {}));
  const BoxStock box = stock_bounds(scene.scene.settings.stock);
  EXPECT_EQ(box.min_mm, (Vec3{-10, -20, -30}));
  EXPECT_EQ(box.max_mm, (Vec3{40, 30, 1}));
  EXPECT_EQ(scene.scene.tools.at(2).tool.radius_mm, 4);
  EXPECT_THAT(scene.notes, Contains(HasSubstr("BLK FORM")));
}

}  // namespace
}  // namespace kerf::klartext_test
