// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/pose_script.h"

#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::agent::pose_script_test {
namespace {

PoseScript apt(const std::string& text) {
  auto script = parse_apt_script("path.apt", text);
  EXPECT_TRUE(script) << to_string(script.error());
  return script ? *script : PoseScript{};
}

TEST(AptScript, MovesAtTheProgrammedFeed) {
  const auto script =
      apt("PARTNO/ANY TEXT, EVEN WITH / AND ,\n$$ a comment\nUNITS/MM\nMULTAX\nLOADTL/3\n"
          "SPINDL/1000,RPM\nGOTO/0,0,10\nFEDRAT/600,MMPM\nGOTO/20,0,10,0,0,2 $$ ten mm a second\n"
          "GOTO/20,30,10\nFINI\n");
  ASSERT_EQ(script.size(), 3U);
  EXPECT_FALSE(script[0].cutting);
  EXPECT_EQ(script[0].tool_id, 3U);
  EXPECT_TRUE(script[1].cutting);
  EXPECT_DOUBLE_EQ(script[1].time_s - script[0].time_s, 2.0);
  EXPECT_EQ(script[1].axis, (Vec3{0, 0, 1})) << "the axis is normalised";
  EXPECT_DOUBLE_EQ(script[2].time_s - script[1].time_s, 3.0);
}

TEST(AptScript, RapidAppliesToOneMove) {
  const auto script = apt("FEDRAT/60\nGOTO/0,0,0\nRAPID\nGOTO/100,0,0\nGOTO/101,0,0\n");
  ASSERT_EQ(script.size(), 3U);
  EXPECT_NEAR(script[1].time_s, 100.0 / kRapidMmPerS, 1e-12);
  EXPECT_NEAR(script[2].time_s - script[1].time_s, 1.0, 1e-12);
  EXPECT_TRUE(script[1].cutting) << "a RAPID through the stock cuts it";
}

TEST(AptScript, ContinuationLinesAreJoined) {
  const auto script = apt("FEDRAT/60\nGOTO/0,0,0\nGOTO/1,0, $ more follows\n 0, 0,0,1\n");
  ASSERT_EQ(script.size(), 2U);
  EXPECT_EQ(script[1].tip_mm, (Vec3{1, 0, 0}));
}

TEST(AptScript, MoveAfterToolChangeDoesNotCut) {
  const auto script =
      apt("FEDRAT/60\nGOTO/0,0,0\nGOTO/1,0,0\nLOADTL/2\nGOTO/50,0,0\nGOTO/51,0,0\n");
  ASSERT_EQ(script.size(), 4U);
  EXPECT_FALSE(script[2].cutting);
  EXPECT_EQ(script[2].tool_id, 2U);
  EXPECT_GT(script[2].time_s, script[1].time_s) << "the move takes time";
  EXPECT_TRUE(script[3].cutting);
}

TEST(AptScript, RotationTakesTime) {
  const auto script =
      apt("FEDRAT/60\nGOTO/0,0,0,0,0,1\nGOTO/0,0,0,1,0,0\nFINI\nGOTO/anything may follow\n");
  EXPECT_NEAR(script[1].time_s, 90.0, 1e-9) << "a feed of 60 is one degree per second";
}

struct BadText {
  const char* text;
  std::size_t line;
  const char* word;
};

class BadApt : public ::testing::TestWithParam<BadText> {};

TEST_P(BadApt, IsRejectedWithItsLine) {
  const auto error = test::error_of(parse_apt_script("bad.apt", GetParam().text));
  EXPECT_EQ(error.line, GetParam().line);
  EXPECT_NE(error.reason.find(GetParam().word), std::string::npos) << error.reason;
  EXPECT_TRUE(to_string(error).starts_with("bad.apt:"));
}

INSTANTIATE_TEST_SUITE_P(
    AptScript, BadApt,
    ::testing::Values(
        BadText{"", 0, "no GOTO"}, BadText{"PARTNO/X\n", 0, "no GOTO"},
        BadText{"FEDRAT/60\n\nGOTO/1,2\n", 3, "3 or 6"}, BadText{"GOTO/1,2,nan\n", 1, "finite"},
        BadText{"GOTO/1,2,3x\n", 1, "3x"}, BadText{"GOTO/1,,3\n", 1, "finite"},
        BadText{"GOTO/1,2,3,0,0,0\n", 1, "length"},
        BadText{"GOTO/0,0,0\nGOTO/1,0,0\n", 2, "FEDRAT"}, BadText{"FEDRAT/0\n", 1, "above zero"},
        BadText{"FEDRAT/10,IPM\n", 1, "IPM"}, BadText{"UNITS/INCHES\n", 1, "UNITS"},
        BadText{"GOTO/0,0,0\nCIRCLE/1,2\n", 2, "CIRCLE"}, BadText{"LOADTL/1.5\n", 1, "LOADTL"},
        BadText{"LOADTL/0\n", 1, "LOADTL"}, BadText{"DELAY/-1\n", 1, "DELAY"},
        BadText{"FEDRAT/1\nGOTO/0,0,0,0,0,1\nGOTO/0,0,0,0,0,-1\n", 3, "turns"}));

TEST(CsvScript, ReadsTheForcesFileOfACarving) {
  const auto script = test::value_of(
      parse_csv_script("forces.csv",
                       "t_s,x,y,z,i,j,k,fx_n,fy_n,fz_n,tx_nmm,ty_nmm,tz_nmm,removed_mm3\n"
                       "0.5,1,2,3,0,0,1,0,0,0,0,0,0,0\r\n\n0.75,4,5,6,0,3,4,1,1,1,0,0,0,9\n"));
  ASSERT_EQ(script.size(), 2U);
  EXPECT_FALSE((script)[0].cutting);
  EXPECT_TRUE((script)[1].cutting);
  EXPECT_DOUBLE_EQ((script)[1].time_s, 0.75);
  EXPECT_EQ((script)[1].axis, (Vec3{0, 0.6, 0.8}));
}

TEST(CsvScript, ColumnsInAnyOrderWithCutting) {
  const auto script =
      test::value_of(parse_csv_script("p.csv",
                                      "tool,cutting,k,j,i,z,y,x,t_s\n4,1,1,0,0,3,2,1,0\n"
                                      "4,0,1,0,0,3,2,1,1\n4,1,1,0,0,3,2,1,2\n"));
  EXPECT_EQ((script)[0].tip_mm, (Vec3{1, 2, 3}));
  EXPECT_EQ((script)[0].tool_id, 4U);
  EXPECT_FALSE((script)[1].cutting);
  EXPECT_TRUE((script)[2].cutting);
}

class BadCsv : public ::testing::TestWithParam<BadText> {};

TEST_P(BadCsv, IsRejectedWithItsLine) {
  const auto error = test::error_of(parse_csv_script("bad.csv", GetParam().text));
  EXPECT_EQ(error.line, GetParam().line);
  EXPECT_NE(error.reason.find(GetParam().word), std::string::npos) << error.reason;
}

INSTANTIATE_TEST_SUITE_P(
    CsvScript, BadCsv,
    ::testing::Values(BadText{"", 0, "empty"}, BadText{"t_s,x,y,z,i,j\n", 1, "column k"},
                      BadText{"t_s,x,y,z,i,j,k\n", 0, "no row"},
                      BadText{"t_s,x,y,z,i,j,k\n1,2,3\n", 2, "3 fields"},
                      BadText{"t_s,x,y,z,i,j,k\n1,2,inf,0,0,0,1\n", 2, "inf"},
                      BadText{"t_s,x,y,z,i,j,k\n1,2,3,0,0,0,0\n", 2, "length"},
                      BadText{"t_s,x,y,z,i,j,k\n1,2,3,0,0,0,1\n0,2,3,0,0,0,1\n", 3, "decrease"},
                      BadText{"t_s,x,y,z,i,j,k,tool\n1,2,3,0,0,0,1,-1\n", 2, "tool"}));

TEST(LoadScript, ReportsFileErrors) {
  EXPECT_NE(to_string(load_script("/no/such/file.apt").error()).find("cannot be read"),
            std::string::npos);
  const test::TemporaryFolder folder;
  const auto path = folder / "program.ngc";
  std::ofstream(path) << "G0 X1\n";
  EXPECT_NE(to_string(load_script(path.string()).error()).find("not a pose list"),
            std::string::npos);
}

}  // namespace
}  // namespace kerf::agent::pose_script_test
