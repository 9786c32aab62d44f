// SPDX-License-Identifier: Apache-2.0
// SINUMERIK programs, against paths computed by hand.
#include "server/formats/derived_scene.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::sinumerik_test {
namespace {

using test::scene_for;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kHead = "T1 M6\nG0 X0 Y0\nZ5 S1000 M3\nF600\n";

std::expected<Program, ProgramError> read(const std::string& text, const char* machine = "xyz") {
  GcodeEnvironment environment{.dialect = Dialect::kSiemens, .lines_max = 5000};
  return parse_program("p.mpf", text, scene_for(machine), environment);
}

// Ends of the motions after the head, rounded to 0.001 mm.
std::vector<Vec3> ends(const std::string& body, const char* machine = "xyz") {
  const auto program = read(kHead + body + "M30\n", machine);
  EXPECT_TRUE(program) << to_string(program.error());
  return program ? test::rounded_ends(*program) : std::vector<Vec3>{};
}

Vec3 end(const std::string& body, const char* machine = "xyz") {
  const auto tips = ends(body, machine);
  return tips.empty() ? Vec3{-1e9, 0, 0} : tips.back();
}

std::string error(const std::string& body, const char* machine = "xyz") {
  const auto program = read(kHead + body + "M30\n", machine);
  return program ? "none" : to_string(program.error());
}

TEST(Sinumerik, ReadsWordsWithAndWithoutBlanksAndEqualSigns) {
  EXPECT_THAT(ends("N10 G1X10Y-5.5 Z=-1 ; a comment\ng1 x=ic(2) y=AC(.5)\n/G1 X99\nG91 X1\nG90\n"),
              ElementsAre(Vec3{10, -5.5, -1}, Vec3{12, 0.5, -1}, Vec3{13, 0.5, -1}));
  EXPECT_THAT(ends("%_N_PART_MPF\n;$PATH=/_N_MPF_DIR\nMSG (\"X5; Y6\")\nG64 SOFT G1 X1 D1\n"),
              ElementsAre(Vec3{1, 0, 5}));
}

TEST(Sinumerik, InchesCountForLengthsAndWithG700ForFeedsToo) {
  EXPECT_EQ(end("G70 G1 X1\nG71 Y1\n"), (Vec3{25.4, 1, 5}));
  const auto seconds = [](const std::string& unit) {
    const auto program = read(kHead + unit + " G1 X1 F60\nM30\n");
    return program ? program->motions.back().duration_s : 0;
  };
  EXPECT_NEAR(seconds("G70"), 25.4, 1e-6);
  EXPECT_NEAR(seconds("G700"), 1, 1e-6);
  EXPECT_NEAR(seconds("G710"), 1, 1e-6);
}

TEST(Sinumerik, ComputesParametersVariablesAndFunctions) {
  EXPECT_EQ(end("R1=5 R2=2\nDEF REAL LEN=3, WIDE\nWIDE=LEN*2+R[R2]\nG1 X=R1+1 Y=WIDE Z=-R1\n"),
            (Vec3{6, 8, -5}));
  EXPECT_EQ(end("G1 X=10*SIN(30) Y=SQRT(POT(3)+16) Z=-(7 DIV 2)\n"), (Vec3{5, 5, -3}));
  EXPECT_EQ(end("G1 X=ATAN2(1,1) Y=7 MOD 4 Z=TRUNC(2.9)-ROUND(2.5)\n"), (Vec3{45, 3, -1}));
  EXPECT_EQ(end("R1=1\nR1=2 G1 X=R1\nG1 Y=R1\n"),
            (Vec3{1, 2, 5}));  // values at the start of the block
}

TEST(Sinumerik, ArcsHaveACenterARadiusOrAPointBetween) {
  for (const char* arc :
       {"G2 X10 Y0 I5 J0", "G2 X10 I=AC(5) J=AC(0)", "G2 X10 Y0 CR=5", "CIP X10 Y0 I1=5 J1=5"}) {
    const auto tips = ends(std::string("G1 Z0\n") + arc + "\n");
    EXPECT_EQ(tips.back(), (Vec3{10, 0, 0})) << arc;
    EXPECT_THAT(tips, testing::Each(testing::Field(&Vec3::y, testing::Ge(0)))) << arc;
    EXPECT_GT(std::ranges::max(tips, {}, &Vec3::y).y, 4.9) << arc;
  }
  const auto tips = ends("G3 X10 Y0 CR=-5.1\n");
  EXPECT_LT(std::ranges::min(tips, {}, &Vec3::y).y, -5.1);
}

TEST(Sinumerik, TurnAddsWholeCirclesToAHelix) {
  const auto tips = ends("G1 Z0\nG3 X0 Y0 Z-3 I5 TURN=2\n");
  EXPECT_EQ(tips.back(), (Vec3{0, 0, -3}));
  const auto far = std::ranges::count_if(tips, [](Vec3 p) { return p.x > 9.9; });
  EXPECT_GE(far, 3);
  const auto once = ends("G1 Z0\nG3 X0 Y0 Z-3 I5\n");
  EXPECT_NEAR(static_cast<double>(tips.size() - 1), 3.0 * static_cast<double>(once.size() - 1), 1);
}

TEST(Sinumerik, FramesShiftAndRotate) {
  EXPECT_EQ(end("TRANS X10 Y5\nG1 X1 Y1\n"), (Vec3{11, 6, 5}));
  EXPECT_EQ(end("TRANS X10\nATRANS Y5\nG1 X1 Y1\n"), (Vec3{11, 6, 5}));
  EXPECT_EQ(end("TRANS X10\nTRANS Y5\nG1 X1 Y1\n"), (Vec3{1, 6, 5}));
  EXPECT_EQ(end("TRANS X10\nAROT Z90\nG1 X1 Y0\n"), (Vec3{10, 1, 5}));
  EXPECT_EQ(end("ROT RPL=90\nATRANS X10\nG1 X1 Y0\n"), (Vec3{0, 11, 5}));
  EXPECT_EQ(end("TRANS X10\nAROT Z90\nTRANS\nG1 X1 Y0\n"), (Vec3{1, 0, 5}));
  EXPECT_EQ(end("TRANS X10\nROT\nG1 X1 Y0\n"), (Vec3{1, 0, 5}));
}

TEST(Sinumerik, JumpsAndLoops) {
  EXPECT_EQ(end("GOTOF OVER\nG1 X99\nOVER: G1 X1\n"), (Vec3{1, 0, 5}));
  EXPECT_EQ(end("R1=0\nAGAIN: R1=R1+1\nG1 X=IC(1)\nIF R1<3 GOTOB AGAIN\n"), (Vec3{3, 0, 5}));
  EXPECT_EQ(end("GOTOF N50\nG1 X99\nN50 G1 X2\n"), (Vec3{2, 0, 5}));
  EXPECT_EQ(end("R1=2\nIF (R1==1) OR (R1>5)\nG1 X1\nELSE\nG1 X2\nENDIF\nG1 Y1\n"), (Vec3{2, 1, 5}));
  EXPECT_EQ(end("R1=1\nIF R1==1\nG1 X1\nELSE\nG1 X2\nENDIF\nG1 Y1\n"), (Vec3{1, 1, 5}));
  EXPECT_EQ(end("R1=0\nWHILE R1<4\nR1=R1+1\nG1 X=R1\nENDWHILE\n"), (Vec3{4, 0, 5}));
  EXPECT_EQ(end("DEF INT I\nFOR I=1 TO 3\nG91 G1 X=I\nENDFOR\nG90\n"), (Vec3{6, 0, 5}));
  EXPECT_EQ(end("R1=0\nREPEAT\nR1=R1+1\nG1 X=R1\nUNTIL R1>=2\n"), (Vec3{2, 0, 5}));
  EXPECT_EQ(end("R1=0\nLOOP\nR1=R1+1\nIF R1>3\nGOTOF OUT\nENDIF\nG1 X=R1\nENDLOOP\nOUT: G1 Y1\n"),
            (Vec3{3, 1, 5}));
  for (const char* word : {"ELSE", "ENDIF", "UNTIL R1>1", "ENDLOOP", "ENDFOR", "ENDWHILE"})
    EXPECT_THAT(error("R1=0\nG1 X1 F9\n" + std::string(word) + "\nG1 X2\n"),
                HasSubstr("has no other end"));
  EXPECT_THAT(error("R1=0\nWHILE R1<4\nG1 X1\n"), HasSubstr("has no end"));
  EXPECT_THAT(error("LOOP\nR1=1\nENDLOOP\n"), HasSubstr("too many lines"));
  EXPECT_THAT(error("GOTOF NOWHERE\n"), HasSubstr("'NOWHERE' is no label"));
}

TEST(Sinumerik, CyclesDrillToTheirDepth) {
  // RTP, RFP, SDIS, DP
  EXPECT_THAT(ends("G0 X10\nCYCLE81(20,0,2,-8)\n"),
              ElementsAre(Vec3{10, 0, 5}, Vec3{10, 0, 2}, Vec3{10, 0, -8}, Vec3{10, 0, 20}));
  EXPECT_THAT(ends("CYCLE82(20,1,2,,8,0.5)\n"),
              ElementsAre(Vec3{0, 0, 3}, Vec3{0, 0, -7}, Vec3{0, 0, -7}, Vec3{0, 0, 20}));
  const auto holes = ends("MCALL CYCLE83(9,0,1,-4,,,,,,1,1,0)\nX10\nX20 Y5\nMCALL\nX30\n");
  EXPECT_THAT(holes, Contains(Vec3{10, 0, -4}));
  EXPECT_THAT(holes, Contains(Vec3{20, 5, -4}));
  EXPECT_EQ(holes.back(), (Vec3{30, 5, 9}));
  EXPECT_EQ(holes.size(), 9u);
  for (const char* cycle : {"CYCLE84(9,0,1,-4,,0,3,,1,0,500,500)", "CYCLE85(9,0,1,-4,,0,200,300)",
                            "CYCLE86(9,0,1,-4,,0,3,0,0,0,0)"})
    EXPECT_THAT(ends(std::string(cycle) + "\n"), Contains(Vec3{0, 0, -4})) << cycle;
}

TEST(Sinumerik, TheControlFollowsTheToolWithTraori) {
  // With TRAORI the coordinates are those of the tip. Without it the table turns under them.
  const std::string turn = "TRAORI\nG1 X10 Y0 Z-2 A30 C0\n";
  const auto program = test::value_of(read(kHead + turn + "M30\n", "xyzac-trt"));
  EXPECT_EQ(program.motions.back().to.tip_mm, (Vec3{10, 0, -2}));
  EXPECT_NEAR(program.motions.back().to.axis.y, 0.5, 1e-6);
  EXPECT_EQ(end(turn + "TRAFOOF\nG1 X0\n", "xyzac-trt").z,
            end("G1 X10 Y0 Z-2 A30 C0\n"
                "TRAORI\nG1 X10 Y0 Z-2\nTRAFOOF\nG1 X0\n",
                "xyzac-trt")
                .z);
  EXPECT_NE(end("G1 X10 Y3 Z-2 A30 C0\n", "xyzac-trt"), (Vec3{10, 3, -2}));
  const auto vectors =
      test::value_of(read(kHead + "TRAORI\nG1 X10 Z-2 A3=0.6 B3=0 C3=0.8\nM30\n", "tool-vector"));
  EXPECT_NEAR(vectors.motions.back().to.axis.x, 0.6, 1e-9);
  EXPECT_THAT(error("TRAORI\n"), HasSubstr("requires a scene whose machine is xyzac-trt"));
  EXPECT_THAT(error("TRAORI\nG1 X1 A3=0 B3=0 C3=1\n", "xyzac-trt"), HasSubstr("tool-vector"));
  EXPECT_THAT(error("G1 X1 A3=0 B3=0 C3=1\n", "tool-vector"), HasSubstr("requires TRAORI"));
}

TEST(Sinumerik, MachinePositionsMoveTheToolAway) {
  for (const char* away : {"G0 SUPA Z100 D0", "G53 G0 Z100", "G153 Z100", "G75 Z1=0", "G74 Z1=0"}) {
    const auto program = read(kHead + "G1 X5 Z-1\n" + away + "\nG0 X20 Y3\nZ2\nG1 Z-1\nM30\n");
    ASSERT_TRUE(program) << away << to_string(program.error());
    ASSERT_EQ(program->motions.size(), 2u) << away;
    EXPECT_EQ(program->motions[1].from.tip_mm, (Vec3{20, 3, 2})) << away;
  }
}

TEST(Sinumerik, Cycle800WithoutAnglesRetractsOnly) {
  EXPECT_EQ(end("CYCLE800()\nG1 X1\n"), (Vec3{1, 0, 5}));
  EXPECT_EQ(end("CYCLE800 (0,\"TC1\",0,57,0,0,0,0,0,0,0,0,0,-1)\nG1 X1\n"), (Vec3{1, 0, 5}));
  const auto tips = ends("CYCLE800(1,\"TC1\",0,57,0,0,0,0,0,0,0,0,0,-1)\nG0 X1\nZ2\nG1 Z1\n");
  EXPECT_THAT(tips, ElementsAre(Vec3{1, 0, 1}));
}

TEST(Sinumerik, ToolsHaveNumbersOrNames) {
  EXPECT_THAT(error("T99 M6\nG1 X1\n"), HasSubstr("the scene has no tool 99"));
  const auto named =
      test::value_of(read("T=\"MILL\"\nM6\nG0 X0 Y0 Z5\nG1 X1 F100\nT=\"BALL\" M6\nG1 X2\nM30\n"));
  EXPECT_EQ(named.motions.front().tool, 1u);
  EXPECT_EQ(named.motions.back().tool, 2u);
  const auto at_once = test::value_of(read("T2\nG0 X0 Y0 Z5\nG1 X1 F100\nM30\n"));
  EXPECT_EQ(at_once.motions.back().tool, 2u);
  EXPECT_THAT(at_once.warnings, Contains(HasSubstr("T changes the tool at once")));
}

TEST(Sinumerik, DwellsInSecondsAndTurns) {
  const auto program = test::value_of(read(kHead + "G1 X1\nG4 F2.5\nG4 S100\nG1 X2\nM30\n"));
  ASSERT_EQ(program.motions.size(), 4u);
  EXPECT_NEAR(program.motions[1].duration_s, 2.5, 1e-9);
  EXPECT_NEAR(program.motions[2].duration_s, 6, 1e-9);  // at 1,000 per minute
  EXPECT_NEAR(program.motions[3].duration_s, 0.1, 1e-9);
}

TEST(Sinumerik, SpindleCoolantAndStopsAreCarried) {
  using Kind = MachineRemark::Kind;
  const auto program =
      test::value_of(read("T1 M6 ; head\nS800 M3 M8\nG0 X0 Y0 Z5 ; go\nG1 X1 F100\nM1\nM5\nM30\n"));
  std::vector<Kind> kinds;
  for (const ProgramRemark& remark : program.remarks) kinds.push_back(remark.said.kind);
  EXPECT_THAT(kinds, ElementsAre(Kind::kSpindleClockwise, Kind::kFlood, Kind::kComment,
                                 Kind::kOptionalStop, Kind::kSpindleStop));
  EXPECT_EQ(program.remarks.front().said.rpm, 800);
}

// A square of 40 mm that a tool of 10 mm follows on the outside, and on the inside from an entry
// below.
TEST(Sinumerik, CompensationStaysOutsideTheContour) {
  const auto path = ends("G0 X20 Y-30\nG1 Z-1\nG42 Y0\nX40\nY40\nX0\nY0\nX20\nG40 Y-30\nG0 Z5\n");
  double left = 0, right = 0, back = 0;
  for (const Vec3 p : path) {
    left = std::min(left, p.x);
    right = std::max(right, p.x);
    back = std::max(back, p.y);
  }
  EXPECT_NEAR(left, -5, 1e-9);
  EXPECT_NEAR(right, 45, 1e-9);
  EXPECT_NEAR(back, 45, 1e-9);
  EXPECT_EQ(path.back(), (Vec3{20, -30, 5}));
}

// The entry ends across the next move (NORM), the path across its last one.
TEST(Sinumerik, CompensationStartsAcrossTheNextMove) {
  const auto path = ends("G0 X-40 Y-20\nG1 Z-1\nG41 X0\nY30\nG40 X-40\nG0 Z5\n");
  EXPECT_THAT(path, Contains(Vec3{-5, -20, -1}));
  EXPECT_THAT(path, Contains(Vec3{-5, 30, -1}));
  EXPECT_THAT(path, testing::Not(Contains(Vec3{0, -15, -1})));
}

// G40 alone causes no motion. A retraction goes straight up.
TEST(Sinumerik, RetractionAfterG40StaysOffThePath) {
  const auto path = ends("G0 X-20\nG1 Z-1\nG41 X0\nX20\nG40\nG0 Z5\n");
  EXPECT_EQ(path.back(), (Vec3{20, 5, 5}));
}

TEST(Sinumerik, CornersAreRoundedAndCut) {
  for (const char* corner : {"RND=2", "CHR=2", "CHF=2.8284271247"}) {
    const auto path = ends("G1 X10 " + std::string(corner) + "\nY10\n");
    EXPECT_THAT(path, Contains(Vec3{8, 0, 5})) << corner;
    EXPECT_THAT(path, Contains(Vec3{10, 2, 5})) << corner;
    EXPECT_THAT(path, testing::Not(Contains(Vec3{10, 0, 5}))) << corner;
    EXPECT_EQ(path.back(), (Vec3{10, 10, 5}));
  }
  EXPECT_THAT(
      ends("RNDM=1\nG1 X10\nY10\nRNDM=0 X0\nY0\n"),
      testing::AllOf(Contains(Vec3{9, 0, 5}), Contains(Vec3{10, 9, 5}), Contains(Vec3{0, 10, 5})));
  EXPECT_THAT(error("G1 X10 RND=2\nG0 X20\n"), HasSubstr("a line (G1) must follow"));
}

TEST(Sinumerik, DrillsPatterns) {
  const std::string drill = "MCALL CYCLE81(5,0,1,-3)\n";
  const auto holes = [&](const std::string& pattern) {
    std::vector<Vec3> bottoms;
    for (const Vec3 p : ends(drill + pattern + "\nMCALL\n"))
      if (p.z == -3) bottoms.push_back(p);
    return bottoms;
  };
  EXPECT_THAT(holes("HOLES1(10,20,90,5,2,2)"), ElementsAre(Vec3{10, 22, -3}, Vec3{10, 27, -3}));
  EXPECT_THAT(holes("HOLES2(10,20,5,0,0,2)"), ElementsAre(Vec3{15, 20, -3}, Vec3{5, 20, -3}));
  EXPECT_THAT(holes("CYCLE801(1,2,0,10,15,2,2)"),
              ElementsAre(Vec3{1, 2, -3}, Vec3{11, 2, -3}, Vec3{11, 17, -3}, Vec3{1, 17, -3}));
  EXPECT_THAT(error("HOLES1(0,0,0,0,5,2)\n"), HasSubstr("MCALL"));
}

TEST(Sinumerik, RejectsUnsupportedWordsByName) {
  const std::pair<const char*, const char*> cases[] = {
      {"G19 G41 G1 Y9", "G41' requires the plane XY"},
      {"CYCLE800(1,\"\",0,57,0,0,0,0,30,0,0,0,0,-1)", "CYCLE800' swivels the plane, which"},
      {"POCKET3(1,2,3)", "POCKET3' requires lengths"},
      {"MCALL HOLES", "MCALL' is supported with CYCLE81"},
      {"MIRROR X0", "MIRROR' is not supported"},
      {"ROT X30", "X' tilts the plane"},
      {"G2 X2 I1 RND=2", "RND, CHF and CHR beside an arc"},
      {"G1 X1 Q5", "Q' is not a supported word"},
      {"SUBPROGRAM", "SUBPROGRAM' is not a supported word"},
      {"G1 X=$AA_IM[X]", "$AA_IM' is a system variable"},
      {"G1 X=UNKNOWN", "UNKNOWN' is not a variable"},
      {"G1 X=1/0", "divides by 0"},
      {"G2 X5", "requires a center"},
      {"CIP X10 I1=5", "not on a line"},
      {"G1 X=ACP(5)", "X' with ACP"},
      {"G33 Z-5", "G33' is not supported"},
      {"G1 A5", "the machine xyz has no A axis"},
      {"CYCLE81(20,0,2)", "requires DP or DPR"},
      {"CYCLE81(20,0,2,8)", "depth above"},
      {"R[-1]=5", "out of range"},
      {"G1 X=(((1)", "lacks ')'"}};
  for (const auto& [body, reason] : cases) {
    EXPECT_THAT(error(std::string(body) + "\n"), HasSubstr(reason)) << body;
    EXPECT_THAT(error(std::string(body) + "\n"), HasSubstr("(read as SINUMERIK)")) << body;
    EXPECT_THAT(error(std::string(body) + "\n"), HasSubstr("p.mpf:5:")) << body;
  }
  std::string powers = "G1 X=0";
  for (int i = 0; i < 200; ++i) powers += "EX0";
  for (const std::string& deep : {"G1 X=" + std::string(5000, '('), powers})
    EXPECT_THAT(error(deep + "\n"), HasSubstr("nested deeper than 100 levels"));
}

TEST(Sinumerik, IsRecognizedAndDerivesAScene) {
  const std::string text =
      "T=\"MILL\" M6\nMSG(\"POCKET\")\nG0 X0 Y0\nZ5\nG1 Z-2 F100\nG1 X30\nG2 X40 Y10 CR=10\nM30\n";
  const auto program = test::value_of(parse_program("p.mpf", text, scene_for("xyz")));
  EXPECT_THAT(program.warnings, Contains(HasSubstr("read as SINUMERIK: line 1 has T=\"")));
  EXPECT_TRUE(test::value_of(derive_scene("p.mpf", text, {}, {})).scene.tools.contains(1));
  EXPECT_THAT(parse_program("p.mpf", "T1 M6\nG0 X0 Y0 Z5\nG1 X1 F1\nM2\n", scene_for("xyz"))
                  .value()
                  .read_as,
              HasSubstr("SINUMERIK: its name ends in .mpf"));
}

}  // namespace
}  // namespace kerf::sinumerik_test
