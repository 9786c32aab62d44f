// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program_facts.h"

#include "tests/support/test.h"

namespace kerf::program_facts_test {
namespace {

ProgramFacts facts(const std::string& text, const std::string& name = "part.ngc") {
  const auto read = program_facts(name, text);
  EXPECT_TRUE(read) << to_string(read.error());
  return read ? *read : ProgramFacts{};
}

TEST(ProgramFacts, BoxCoversTheFeeds) {
  const auto read = facts(
      "G21 G90\n(T9 is not used)\nT2 M6\nG0 X-50 Y90 Z30\nG0 X10 Y0 Z5\nG1 Z-3 F600\n"
      "G1 X40 Y20\nG1 Z25\nT11 M6\nG0 X0 Y0\nG1 Z-1\nG3 X20 Y0 I10 J0\nG0 Z40\nM30\n");
  EXPECT_EQ(read.kinematics, MachineKinematics::kXyz);
  EXPECT_THAT(read.tools, testing::ElementsAre(2, 11));
  ASSERT_TRUE(read.cuts);
  EXPECT_NEAR(read.cuts->tip_mm.min_mm.x, 0, 1e-6);
  EXPECT_NEAR(read.cuts->tip_mm.min_mm.y, -10, 0.02) << "of the arc, not of its ends";
  EXPECT_NEAR(read.cuts->tip_mm.min_mm.z, -3, 1e-6);
  EXPECT_NEAR(read.cuts->tip_mm.max_mm.x, 40, 1e-6);
  EXPECT_NEAR(read.cuts->tip_mm.max_mm.y, 20, 1e-6);
  EXPECT_NEAR(read.cuts->tip_mm.max_mm.z, -1, 1e-6) << "a retraction at feed rate does not count";
  EXPECT_GT(read.motions, 10U);
  EXPECT_GT(read.duration_s, 3);
}

TEST(ProgramFacts, BoxCoversRowsThatBeginAfterARapidPlunge) {
  std::string rows = "G21 G90\nT1 M6\n";
  for (const char* y : {"0", "10", "20"}) {
    rows += std::string("G0 X-5 Y") + y + "\nG0 Z-2\nG1 X105 F500\nG0 Z5\n";
  }
  const auto read = facts(rows);
  ASSERT_TRUE(read.cuts);
  EXPECT_EQ(read.cuts->tip_mm.min_mm, (Vec3{-5, 0, -2}));
  EXPECT_EQ(read.cuts->tip_mm.max_mm, (Vec3{105, 20, -2}));
}

TEST(ProgramFacts, FindsTheMachine) {
  const std::string head = "G21 G90\nT1 M6\nG0 X0 Y0 Z5\n";
  EXPECT_EQ(facts(head + "G1 X5 A10 C20 F500\n").kinematics, MachineKinematics::kXyzacTrt);
  EXPECT_EQ(facts(head + "G1 X5 B10 C20 F500\n").kinematics, MachineKinematics::kXyzbcTrt);
  EXPECT_EQ(facts(head + "G1 X5 I0 J0.6 K0.8 F500\n").kinematics, MachineKinematics::kToolVector);
}

TEST(ProgramFacts, ReadsApt) {
  const auto read =
      facts("UNITS/MM\nLOADTL/7\nFROM/0,0,20\nFEDRAT/500,MMPM\nGOTO/0,0,-2\nGOTO/30,0,-2\nFINI\n",
            "part.apt");
  EXPECT_THAT(read.tools, testing::ElementsAre(7));
  ASSERT_TRUE(read.cuts);
  EXPECT_EQ(read.cuts->tip_mm.max_mm, (Vec3{30, 0, -2}));
}

TEST(ProgramFacts, RadiusOffsetsArePossible) {
  const auto read = facts(
      "G21 G90\nT3 M6\nG0 X-5 Y0 Z5\nG1 Z-1 F500\nG41 D3 G1 X0 Y0\nG1 X10 Y0\n"
      "G1 X10 Y0.5\nG1 X0 Y0.5\nG40 G1 X-5 Y5\n");
  EXPECT_THAT(read.tools, testing::ElementsAre(3));
}

TEST(ProgramFacts, AProgramWithoutFeedsHasNoBox) {
  const auto read = facts("G21\nT1 M6\nG0 X0 Y0 Z5\nG0 X9\n");
  EXPECT_FALSE(read.cuts);
  EXPECT_TRUE(facts("M30\n").tools.empty());
}

TEST(ProgramFacts, ErrorIsThatOfTheMachineThatReadsFarthest) {
  const auto error =
      test::error_of(program_facts("part.ngc", "G21\nT1 M6\nG0 X0 Y0 Z5 A0\nG1 A20 F5\nG77\n"));
  EXPECT_EQ(error.line, 5U);
  EXPECT_EQ(error.word, "G77");
  EXPECT_EQ(program_facts("part.doc", "").error().line, 0U);
}

}  // namespace
}  // namespace kerf::program_facts_test
