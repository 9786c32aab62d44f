// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::apt_reader_test {
namespace {

using test::error_of;
using test::scene_for;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Program apt(const std::string& text, const std::string& kinematics = "tool-vector") {
  return test::read(scene_for(kinematics), "p.apt", text);
}

const std::string kStart =
    "PARTNO/a part, with $ and /\nUNITS/MM\nMULTAX/ON\nLOADTL/1\nFEDRAT/600,MMPM\n";

TEST(AptReader, FirstGotoPlacesTheToolWithoutMotion) {
  const Program program = apt(kStart + "GOTO/1,2,3\nGOTO/11,2,3\nFINI\n");
  ASSERT_EQ(program.motions.size(), 1u);
  EXPECT_EQ(program.motions[0],
            (ProgramMotion{1, {{1, 2, 3}, {0, 0, 1}}, {{11, 2, 3}, {0, 0, 1}}, 1.0, 7, false}));
  EXPECT_THAT(program.warnings, IsEmpty());
}

TEST(AptReader, FromPlacesTheToolWithoutMotion) {
  const Program program =
      apt(kStart + "FROM/0,0,0\nGOTO/1,0,0\nFROM/5,5,5,0,1,0\nGOTO/6,5,5,0,1,0\nFINI\n");
  ASSERT_EQ(program.motions.size(), 2u);
  EXPECT_EQ(program.motions[1].from, (ToolPose{{5, 5, 5}, {0, 1, 0}}));
}

TEST(AptReader, ToolAxisIsModal) {
  const Program program =
      apt(kStart + "GOTO/0,0,0,0,3,4\nGOTO/1,0,0\nGODLTA/5\nGODLTA/0,0,1\nFINI\n");
  ASSERT_EQ(program.motions.size(), 3u);
  EXPECT_EQ(program.motions[0].to.axis, (Vec3{0, 0.6, 0.8}));
  EXPECT_EQ(program.motions[1].to.tip_mm, (Vec3{1, 3, 4}));
  EXPECT_EQ(program.motions[2].to.tip_mm, (Vec3{1, 3, 5}));
}

TEST(AptReader, FeedsHaveUnits) {
  const auto duration = [](const std::string& feed) {
    return apt(kStart + "SPINDL/200,CLW\n" + feed + "\nFROM/0,0,0\nGOTO/10,0,0\nFINI\n")
        .motions[0]
        .duration_s;
  };
  EXPECT_EQ(duration("FEDRAT/100,MMPM"), 6);
  EXPECT_EQ(duration("FEDRAT/MMPM,100"), 6);
  EXPECT_EQ(duration("FEDRAT/100"), 6);
  EXPECT_EQ(duration("FEDRAT/0.5,MMPR"), 6);
  EXPECT_NEAR(duration("FEDRAT/10,IPM"), 60 / 25.4, 1e-12);
  EXPECT_NEAR(duration("FEDRAT/0.05,IPR"), 60 / 25.4, 1e-12);
  EXPECT_EQ(duration("FEDRAT/100,PERMIN"), 6);
  EXPECT_NEAR(duration("UNITS/INCHES\nFEDRAT/10"), 60, 1e-12);
  EXPECT_EQ(duration("RAPID"), 0.06);
}

TEST(AptReader, RapidAppliesToOneMotion) {
  const Program program = apt(kStart + "FROM/0,0,0\nRAPID\nGOTO/1,0,0\nGOTO/2,0,0\nFINI\n");
  EXPECT_TRUE(program.motions[0].rapid);
  EXPECT_FALSE(program.motions[1].rapid);
}

TEST(AptReader, StatementsWithoutMotionAreAccepted) {
  EXPECT_THAT(
      apt(kStart + "PPRINT any $$ text\nREMARK/x\nSPINDL/ON\nSPINDL/RPM,100,CCLW\nCOOLNT/FLOOD\n"
                   "CUTTER/10,5\nSTOP\nOPSTOP\n$$ a comment\n  goto / 1 , 2 , 3 $$ small\n"
                   "GOTO/4,$\n 5,$ \n6\nDELAY/2\nEND\nFINI\n")
          .warnings,
      IsEmpty());
  EXPECT_THAT(apt(kStart + "CUTTER/8\nGOTO/1,2,3\nFINI\n").warnings,
              ElementsAre(HasSubstr("CUTS NOTHING"), HasSubstr("10 mm")));
}

TEST(AptReader, CutterOfSevenNumbersIsComparedByItsAptDiameter) {
  // Bottom and side line of this taper meet at a diameter of 10 mm. Its top is 14 mm wide.
  const auto scene = test::value_of(parse_scene(
      R"({"stock": {"shape": "box", "min_mm": [0,0,-9], "max_mm": [9,9,0]},
          "tools": [{"id": 1, "shape": "apt", "d_mm": 10, "r_mm": 0, "e_mm": 5, "f_mm": 0,
                     "alpha_deg": 0, "beta_deg": 5.71059, "h_mm": 20}],
          "machine": {"kinematics": "tool-vector"}})",
      {}));
  const std::string load = "LOADTL/1\nCUTTER/";
  EXPECT_THAT(
      test::read(scene, "p.apt", load + "10,0,5,0,0,5.71059,20\nGOTO/1,2,3\nFINI\n").warnings,
      ElementsAre(HasSubstr("CUTS NOTHING")));
  EXPECT_THAT(test::read(scene, "p.apt", load + "14,0,7,0,0,0,20\nGOTO/1,2,3\nFINI\n").warnings,
              ElementsAre(HasSubstr("CUTS NOTHING"), HasSubstr("10 mm")));
}

struct BadStatement {
  const char* text;
  const char* word;
  const char* reason;
};

class BadApt : public testing::TestWithParam<BadStatement> {};

TEST_P(BadApt, IsRejectedWithLineAndWord) {
  const ProgramError error = error_of(scene_for("tool-vector"), "p.apt",
                                      kStart + "FROM/0,0,0\n" + GetParam().text + "\nFINI\n");
  EXPECT_EQ(error.line, 7u);
  EXPECT_EQ(error.word, GetParam().word);
  EXPECT_THAT(error.reason, HasSubstr(GetParam().reason));
}

INSTANTIATE_TEST_SUITE_P(
    AptReader, BadApt,
    testing::Values(BadStatement{"GOFWD/C1", "GOFWD", "is not supported, and moves"},
                    BadStatement{"CYCLE/DRILL,5", "5", "FEDTO"},
                    BadStatement{"CYCLE/DRILL,RAPTO,5", "CYCLE/DRILL", "the depth"},
                    BadStatement{"CIRCLE/0,0,0", "CIRCLE", "takes the center"},
                    BadStatement{"GOTO/1,2", "GOTO", "2 values; it takes x,y,z"},
                    BadStatement{"GOTO/1,2,x", "X", "not a number"},
                    BadStatement{"GOTO/1,2,", "", "a number is missing"},
                    BadStatement{"GOTO/1,2,nan", "NAN", "not a number"},
                    BadStatement{"GOTO/1,2,inf", "INF", "not a number"},
                    BadStatement{"GOTO/1,2,3,0,0,0", "GOTO", "other than 0,0,0"},
                    BadStatement{"GOTO/1,2,3,0,0,-1", "", "opposite"},
                    BadStatement{"GOTO/1,2,9999999", "", "limit"},
                    BadStatement{"GODLTA/1,2", "GODLTA", "it takes 3"},
                    BadStatement{"UNITS/CM", "CM", "not a unit"},
                    BadStatement{"MULTAX/MAYBE", "MAYBE", "ON or OFF"},
                    BadStatement{"LOADTL/9", "9", "not the id of a tool"},
                    BadStatement{"LOADTL/1.5", "1.5", "not the id of a tool"},
                    BadStatement{"FEDRAT/0", "FEDRAT", "above 0"},
                    BadStatement{"FEDRAT/5,6", "6", "second feed"},
                    BadStatement{"CUTTER/0", "CUTTER", "above 0"},
                    BadStatement{"DELAY/-1", "-1", "negative"}));

TEST(AptReader, MissingStatementsAreReported) {
  const Scene scene = scene_for("tool-vector");
  EXPECT_THAT(error_of(scene, "p.apt", "GOTO/1,2,3\n").reason, HasSubstr("no tool is loaded"));
  EXPECT_THAT(error_of(scene, "p.apt", "LOADTL/1\nGOTO/1,2,3\nGOTO/2,2,3\n").reason,
              HasSubstr("feed is 0"));
  EXPECT_THAT(error_of(scene, "p.apt", "LOADTL/1\nFEDRAT/1,MMPR\nGOTO/1,2,3\nGOTO/2,2,3\n").reason,
              HasSubstr("SPINDL"));
  EXPECT_THAT(error_of(scene, "p.apt", "GODLTA/1\n").reason, HasSubstr("requires FROM or GOTO"));
  EXPECT_THAT(error_of(scene, "p.apt", "GOTO/1,2,$").reason, HasSubstr("the file ends"));
  EXPECT_THAT(error_of(scene_for("xyz"), "p.apt", "MULTAX\nLOADTL/1\nGOTO/1,2,3,1,0,0\n").reason,
              HasSubstr("tilts the tool"));
}

}  // namespace
}  // namespace kerf::apt_reader_test
