// SPDX-License-Identifier: Apache-2.0
// APT CL data of other systems, against paths computed by hand.
#include "server/formats/derived_scene.h"
#include "server/formats/program_facts.h"
#include "server/formats/stated_tools.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::apt_systems_test {
namespace {

using test::error_of;
using test::scene_for;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

const std::string kHead = "UNIT/MM\nLOAD/TOOL,1,ADJUST,1\nFEDRAT/MMPM,600.\nFROM/0,0,20\n";

Program apt(const std::string& text, const char* machine = "xyz") {
  return test::read(scene_for(machine), "p.cls", text);
}

std::vector<Vec3> ends(const std::string& body) {
  return test::rounded_ends(apt(kHead + body + "FINI\n"));
}

double lowest(const std::vector<Vec3>& tips, double Vec3::* axis) {
  return (*std::ranges::min_element(tips, {}, axis)).*axis;
}
double highest(const std::vector<Vec3>& tips, double Vec3::* axis) {
  return (*std::ranges::max_element(tips, {}, axis)).*axis;
}

TEST(AptSystems, ToolPathsOfNxNeedNoFini) {
  const Program program = apt(
      "TOOL PATH/CAVITY,TOOL,D10\nTLDATA/MILL,10.0000,0.0000,75.0000,0.0000,0.0000\n"
      "MSYS/0.0,0.0,0.0,1.0,0.0,0.0,0.0,1.0,0.0\n$$ centerline data\nPAINT/PATH\nPAINT/SPEED,10\n"
      "LOAD/TOOL,1\nPAINT/COLOR,186\nRAPID\nGOTO/0.0,0.0,5.0,0.0,0.0,1.0\nFEDRAT/MMPM,250.0000\n"
      "GOTO/0.0,0.0,-1.0\nGOTO/9.0,0.0,-1.0\nPAINT/TOOL,NOMORE\nEND-OF-PATH\n");
  ASSERT_THAT(program.motions, SizeIs(2));
  EXPECT_EQ(program.motions[1].to.tip_mm, (Vec3{9, 0, -1}));
  EXPECT_THAT(program.warnings, SizeIs(0));
  EXPECT_EQ(program.read_as, "APT");
}

TEST(AptSystems, UnnumberedToolsAreNumberedByRank) {
  const Program program = apt(
      "TOOL PATH/A,TOOL,BALL10\nFEDRAT/100\nGOTO/0,0,0\nGOTO/1,0,0\nEND-OF-PATH\n"
      "TOOL PATH/B,TOOL,FLAT10\nGOTO/2,0,0\nEND-OF-PATH\nTOOL PATH/C,TOOL,BALL10\nGOTO/3,0,0\n");
  ASSERT_THAT(program.motions, SizeIs(3));
  EXPECT_EQ(program.motions[0].tool, 1u);
  EXPECT_EQ(program.motions[1].tool, 2u);
  EXPECT_EQ(program.motions[2].tool, 1u);
}

// Counterclockwise about the axis: from (10, 0) to (0, 10) is a quarter turn, about -Z three
// quarters.
TEST(AptSystems, CircleEndsAtTheNextPoint) {
  const auto quarter = ends("GOTO/10,0,0\nCIRCLE/0,0,0,0,0,1.\nGOTO/0,10,0\n");
  EXPECT_EQ(quarter.back(), (Vec3{0, 10, 0}));
  EXPECT_GE(lowest(quarter, &Vec3::x), 0);
  EXPECT_GE(lowest(quarter, &Vec3::y), 0);
  EXPECT_THAT(quarter, Contains(testing::Truly([](Vec3 p) { return p.x > 6 && p.y > 6; })));
  const auto back = ends("GOTO/10,0,0\nCIRCLE/0,0,0,0,0,-1.0,10.0,0.06,0.5,10,0\nGOTO/0,10,0\n");
  EXPECT_NEAR(lowest(back, &Vec3::x), -10, 0.05);
  EXPECT_NEAR(lowest(back, &Vec3::y), -10, 0.05);
}

TEST(AptSystems, ACircleThatEndsAtItsStartIsWhole) {
  const auto ring = ends("GOTO/10,0,0\nCIRCLE/0,0,0,0,0,1.\nGOTO/10,0,0\n");
  EXPECT_NEAR(lowest(ring, &Vec3::x), -10, 0.05);
  EXPECT_NEAR(lowest(ring, &Vec3::y), -10, 0.05);
  EXPECT_NEAR(highest(ring, &Vec3::y), 10, 0.05);
  EXPECT_EQ(ring.back(), (Vec3{10, 0, 0}));
}

TEST(AptSystems, ACircleAboutAnotherAxisLeavesThePlane) {
  const auto arch = ends("GOTO/10,0,0\nCIRCLE/0,0,0,0,-1.,0\nGOTO/-10,0,0\n");
  EXPECT_NEAR(highest(arch, &Vec3::z), 10, 0.05);
  EXPECT_EQ(lowest(arch, &Vec3::y), 0);
}

TEST(AptSystems, OnlyCreoWritesSeveralPointsOfACircle) {
  const std::string body = "GOTO/10,0,0\nCIRCLE/0,0,0,0,0,1\nGOTO/0,10,0\nGOTO/-10,0,0\n";
  EXPECT_GE(lowest(ends(body), &Vec3::y), 0);
  EXPECT_THAT(ends(body),
              testing::Not(Contains(testing::Truly([](Vec3 p) { return p.x < -6 && p.y > 6; }))));
  EXPECT_THAT(ends("$$-> MFGNO / OP010\n" + body),
              Contains(testing::Truly([](Vec3 p) { return p.x < -6 && p.y > 6; })));
}

TEST(AptSystems, CatiaEndsACircleOnALineFromItsCenter) {
  const auto arc = ends(
      "GOTO/10,0,0\nINDIRV/0,-1,0\nTLON,GOFWD/ (CIRCLE/ 0, 0, 0,$\n 10.),ON,2,INTOF,$\n"
      " (LINE/ 0,0,0,$\n -10.,0,0)\n");
  EXPECT_EQ(arc.back(), (Vec3{-10, 0, 0}));
  EXPECT_NEAR(lowest(arc, &Vec3::y), -10, 0.05);
}

TEST(AptSystems, AHoleIsDrilledAtEachPoint) {
  const std::string cycle = "RAPID/\nGOTO/5,5,25\nCYCLE/INIT\n";
  EXPECT_THAT(
      ends(cycle + "CYCLE/DRILL,FEDTO,5.,MMPM,300.,RAPTO,3.,RTRCTO,27.,DWELL,0\nGOTO/5,5,-2\n"
                   "GOTO/9,5,-2\nCYCLE/OFF\nGOTO/9,9,25\n"),
      ElementsAre(Vec3{5, 5, 25}, Vec3{5, 5, 1}, Vec3{5, 5, -7}, Vec3{5, 5, 25}, Vec3{9, 5, 25},
                  Vec3{9, 5, 1}, Vec3{9, 5, -7}, Vec3{9, 5, 25}, Vec3{9, 9, 25}));
  // NX: depths below the point are negative; AUTO retracts to the start of the cycle.
  EXPECT_THAT(
      ends(cycle + "CYCLE/DRILL,RAPTO,3.0,FEDTO,-5.0,RTRCTO,AUTO,MMPM,250.0\nGOTO/7,5,0\n"),
      ElementsAre(Vec3{5, 5, 25}, Vec3{7, 5, 25}, Vec3{7, 5, 3}, Vec3{7, 5, -5}, Vec3{7, 5, 25}));
  // Creo.
  EXPECT_THAT(ends(cycle + "CYCLE / DEEP, DEPTH, 4, STEP, 2, MMPM, 100, CLEAR, 1\nGOTO/5,5,0\n"),
              ElementsAre(Vec3{5, 5, 25}, Vec3{5, 5, 1}, Vec3{5, 5, -4}, Vec3{5, 5, 25}));
  EXPECT_THAT(error_of(scene_for("xyz"), "p.cls", kHead + "CYCLE/DRILL,20.,5.,500.\n").reason,
              HasSubstr("FEDTO"));
}

TEST(AptSystems, AxesAndNormalsWithAPointNeedNoMultax) {
  const Program program = apt(kHead +
                                  "GOTO/0,0,9,0,0.6,0.8\nGOTO/1,0,9,0,0.6,0.8,0,0,1\n"
                                  "TLAXIS/0,0,1\nGOTO/2,0,9\nFINI\n",
                              "tool-vector");
  ASSERT_THAT(program.motions, SizeIs(3));
  EXPECT_EQ(program.motions[1].to.axis, (Vec3{0, 0.6, 0.8}));
  EXPECT_EQ(program.motions[2].to.axis, (Vec3{0, 0, 1}));
}

TEST(AptSystems, UnknownWordsAreWarningsAndMotionsAreNot) {
  const Program program = apt(kHead +
                              "CSI_SET_FLUTE_LENGTH/32.\nFLUXCAP/1.21\nFLUXCAP/1.3\nCOOLNT/BEER\n"
                              "SPINDL/FAST,3000,RANGE,2\nCUTCOM/LEFT\nSELECT/TOOL,2\nGOTO/1,0,0\n"
                              "FINI\n");
  EXPECT_THAT(program.warnings, ElementsAre(HasSubstr("FLUXCAP"), HasSubstr("SPINDL/FAST"),
                                            HasSubstr("CUTCOM is read as wear")));
  for (const char* word : {"GOLFT/L1", "ROTABL/90,CLW", "TRACUT/M1", "THREAD/TURN", "P1=POINT/0,0"})
    EXPECT_NE(error_of(scene_for("xyz"), "p.cls", kHead + word + "\n").reason, "") << word;
}

TEST(AptSystems, AnotherCoordinateSystemIsAnotherSetup) {
  const std::string same = "CSYS/1.,0,0,-59.5,0,1.,0,-59.5,0,0,1.,19.\n";
  const std::string other = "CSYS/-1.,0,0,0,0,1.,0,0,0,0,-1.,0\n";
  EXPECT_THAT(ends(same + "GOTO/1,0,0\n" + same + "GOTO/2,0,0\n"), SizeIs(2));
  EXPECT_THAT(ends("TRNTYP/WORLD,0,0,0\n" + same + "GOTO/1,0,0\n" + other + "GOTO/2,0,0\n"),
              ElementsAre(Vec3{1, 0, 0}, Vec3{2, 0, 0}));
  const auto error = error_of(scene_for("xyz"), "p.cls", kHead + same + other);
  EXPECT_EQ(error.word, "CSYS");
  EXPECT_EQ(error.language, "APT");
}

TEST(AptSystems, AContinuationDoesNotSwallowTheNextPoint) {
  EXPECT_THAT(ends("GOTO/1,0,0$\nGOTO/2,0,0$\nGOTO/3,$\n0,0\n"),
              ElementsAre(Vec3{1, 0, 0}, Vec3{2, 0, 0}, Vec3{3, 0, 0}));
}

TEST(AptSystems, CutterMayPrecedeOrFollowItsToolLoad) {
  const std::string text =
      "UNITS/INCHES\nCUTTER/1.,0,0.5,0,0,0,3.\nLOAD/TOOL,12\nSELECT/TOOL,7\nFEDRAT/10,IPM\n"
      "GOTO/0,0,1\nGOTO/0,0,-1\nLOADTL/7\nCUTTER/0.5,0.25\nGOTO/1,0,-1\nFINI\n";
  const auto stated = stated_tools(text, program_unit_mm(text));
  ASSERT_THAT(stated, SizeIs(2));
  EXPECT_NEAR(std::get<AptShape>(stated.at(12).shape).d_mm, 25.4, 1e-9);
  EXPECT_NEAR(std::get<BallShape>(stated.at(7).shape).diameter_mm, 12.7, 1e-9);
  EXPECT_EQ(stated.at(12).line, 2u);
  EXPECT_THAT(test::value_of(program_facts("p.aptsource", text)).tools, ElementsAre(7, 12));
  const auto derived = test::value_of(derive_scene("p.aptsource", text, {}, {}));
  EXPECT_THAT(derived.notes, Contains(HasSubstr("CUTTER in line 9")));
}

TEST(AptSystems, IsRecognizedByItsStatementsUnderAnyName) {
  const auto program =
      test::value_of(parse_program("p.txt", kHead + "GOTO/1,0,0\nFINI\n", scene_for("xyz")));
  EXPECT_EQ(program.read_as, "APT");
  EXPECT_THAT(error_of(scene_for("xyz"), "p.apt", "hello\n").reason, HasSubstr("no statement"));
}

}  // namespace
}  // namespace kerf::apt_systems_test
