// SPDX-License-Identifier: Apache-2.0
#include "server/formats/drilling_cycles.h"

#include "server/formats/pose_grid.h"
#include "tests/formats/post_fixture.h"
#include "tests/support/test.h"

namespace kerf::drilling_cycles_test {
namespace {

using test::kPosts;
using test::read_back;
using test::scene_for;
using test::text_of;
using testing::HasSubstr;
using testing::Not;

void expect_same(const Program& read, const Program& source, const std::string& text) {
  ASSERT_EQ(read.motions.size(), source.motions.size()) << text;
  for (std::size_t i = 0; i < read.motions.size(); ++i) {
    const ProgramMotion &a = read.motions[i], &b = source.motions[i];
    ASSERT_EQ(a.from, b.from) << i << "\n" << text;
    ASSERT_EQ(a.to, b.to) << i << "\n" << text;
    ASSERT_EQ(a.rapid, b.rapid) << i << "\n" << text;
    ASSERT_EQ(a.tool, b.tool) << i << "\n" << text;
    ASSERT_NEAR(a.duration_s / b.duration_s, 1, a.rapid ? 1e-9 : 1e-3) << i << "\n" << text;
  }
}

std::string head(const char* rest) {
  return std::string("G21 G90\nT1 M6\nG0 X0 Y0\nG0 Z20\n") + rest + "G80\nG0 Z30\nM2\n";
}

TEST(DrillingCycles, HolesAreWrittenAsTheCyclesThatDrilledThem) {
  const Scene scene = scene_for("xyz");
  const Program source = test::gcode(
      scene, head("G99 G81 X10 Y5 Z-4 R2 F100\nX20\nX30 Y6\nG80\nG0 X35\n"
                  "G98 G83 X40 Y5 Z-9.5 R1 Q2.5 F80\nX50\nG99 G73 X60 Z-5 R2 Q3 F90\nX70\n"
                  "G82 X80 Z-1 R2 P0.5 F120\n"));
  EXPECT_THAT(text_of(source, scene, Post::kLinuxcnc),
              HasSubstr("G99 G81 X10 Y5 Z-4 R2 F100\nX20 Y5\nX30 Y6\nG80\nG0 X35\n"));
  EXPECT_THAT(text_of(source, scene, Post::kHaas),
              HasSubstr("G83 X40. Y5. Z-9.5 R1. Q2.5 F80.\nX50. Y5.\nG80\n"
                        "G99 G73 X60. Y5. Z-5. R2. Q3. F90.\nX70. Y5.\nG80\n"
                        "G99 G82 X80. Y5. Z-1. R2. P500 F120.\nG80\nG0 Z30.\n"));
  EXPECT_THAT(text_of(source, scene, Post::kHeidenhain), HasSubstr("R0 FMAX M99\n"));
  EXPECT_THAT(text_of(source, scene, Post::kGrbl), Not(HasSubstr("G8")));
  for (const Post post : kPosts) {
    const std::string text = text_of(source, scene, post);
    expect_same(read_back(scene, text, post), source, text);
  }
}

// Holes of all four cycles at random positions and depths, with motions, remarks and another tool
// between them.
TEST(DrillingCycles, ReadBackGivesTheSameProgram) {
  const Scene scene = scene_for("xyz");
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    std::mt19937_64 random(seed);
    const auto upto = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    std::ostringstream text;
    text << "T1 M6\nG0 X0 Y0\nG0 Z20\nF100\n";
    for (int hole = 0; hole < 12; ++hole) {
      const double r = 0.25 * (1 + upto(12)), z = -0.125 * upto(60);
      if (upto(4) == 0) text << "G80\nG0 Z" << 10 + upto(10) << "\n";
      if (upto(6) == 0) text << "G80\nG0 Z25\nT" << 1 + upto(2) << " M6\nG0 X0 Y0\nG0 Z20\n";
      if (upto(6) == 0) text << "G80\nG1 X" << upto(50) << " Z" << upto(20) << "\n";
      if (upto(6) == 0) text << "M8\n";
      text << (upto(2) == 0 ? "G98 " : "G99 ")
           << std::array{"G81", "G82 P0.25", "G83 Q0.75", "G73 Q1.5"}[upto(4)] << " X" << upto(60)
           << " Y" << upto(60) << " Z" << z << " R" << r << "\n";
      for (int more = upto(3); more > 0; --more) text << "X" << upto(60) << "\n";
    }
    text << "G80\nG0 Z40\nM2\n";
    const Program source = test::gcode(scene, text.str());
    for (const Post post : kPosts) {
      const std::string written = text_of(source, scene, post);
      expect_same(read_back(scene, written, post), source, written);
      if (HasFatalFailure()) return;
    }
  }
}

// Motions that no cycle reproduces stay motions: a plunge before milling, differing feeds, unequal
// pecks, a tap's ascent at feed rate, two holes at one position.
TEST(DrillingCycles, OtherMotionsStayMotions) {
  const Scene scene = scene_for("xyz");
  for (const char* motions :
       {"G0 X10\nG0 Z2\nG1 Z-4 F100\nG1 X20\nG0 Z2\n",
        "G0 X10\nG0 Z2\nG1 Z-4 F100\nG0 Z2\nG0 Z-3.746\nG1 Z-6 F50\nG0 Z2\n",
        "G0 X10\nG0 Z2\nG1 Z-4 F100\nG0 Z2\nG0 Z-3.746\nG1 Z-11 F100\nG0 Z2\n",
        "G0 X10\nG0 Z2\nG1 Z-4 F100\nG1 Z2\nG0 Z20\n",
        "G0 X10\nG0 Z2\nG1 Z-4 F100\nG0 Z2\nG1 Z-4\nG0 Z2\n",
        "G0 X10\nG0 Z2\nG1 Z-4 F100\nG0 Z5\n"}) {
    const Program source = test::gcode(scene, head(motions));
    const std::string text = text_of(source, scene, Post::kFanuc);
    EXPECT_THAT(text, Not(HasSubstr("G80\nG0"))) << text;
    for (const char* cycle : {"G81", "G82", "G83", "G73"})
      EXPECT_THAT(text, Not(HasSubstr(cycle))) << text;
    expect_same(read_back(scene, text, Post::kFanuc), source, text);
  }
}

// A jump or a tilted tool is no part of a hole.
TEST(DrillingCycles, AHoleIsOneMovementOfAnUprightTool) {
  const Scene scene = scene_for("xyz");
  const Program hole = test::gcode(scene, head("G99 G81 X10 Z-4 R2 F100\n"));
  const auto up = std::ranges::find_if(
      hole.motions, [](const ProgramMotion& motion) { return motion.from.tip_mm.z == -4; });
  ASSERT_NE(up, hole.motions.end());
  Program jumps = hole;
  ProgramMotion& rise = jumps.motions[static_cast<std::size_t>(up - hole.motions.begin())];
  rise.from.tip_mm.z = 0;
  rise.duration_s /= 3;
  const std::string text = text_of(jumps, scene, Post::kLinuxcnc);
  EXPECT_THAT(text, Not(HasSubstr("G81")));
  expect_same(read_back(scene, text, Post::kLinuxcnc), jumps, text);

  Program leans = hole;
  for (ProgramMotion& motion : leans.motions)
    motion.from.axis = motion.to.axis = admit_pose({{}, {0.1, 0, 1}}).axis;
  std::ostringstream out;
  const WriteResult written =
      write_program(leans, **make_program_writer({.post = Post::kLinuxcnc}, scene, out));
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error(), HasSubstr("the tool is tilted"));
}

// A remark stays before its motion. A hole with a remark inside stays motions.
TEST(DrillingCycles, RemarkKeepsItsPosition) {
  const Scene scene = scene_for("xyz");
  const Program source = test::gcode(
      scene, head("G0 X10\nG0 Z2\nG1 Z-4 F100\nM9\nG0 Z2\nG0 X20\nM8\nG1 Z-4\nG0 Z2\n"));
  const std::string text = text_of(source, scene, Post::kLinuxcnc);
  EXPECT_THAT(text, HasSubstr("G1 Z-4 F100\nM9\nG0 Z2\nX20\nM8\nG99 G81 X20 Y0 Z-4 R2 F100\n"));
  const Program read = read_back(scene, text, Post::kLinuxcnc);
  EXPECT_EQ(read.remarks, source.remarks);
}

// With a tolerance, the motions around a hole are joined, but not with those of the hole.
TEST(DrillingCycles, HolesStayApartFromJoinedMotions) {
  const Scene scene = scene_for("xyz");
  const Program source =
      test::gcode(scene, head("G1 X3 F100\nG1 X6\nG99 G81 X10 Z-4 R2\nG80\nG0 Z5\n"));
  std::ostringstream out;
  auto writer = make_program_writer({.tolerance_mm = 0.01}, scene, out);
  ASSERT_TRUE(write_program(source, **writer));
  EXPECT_THAT(out.str(), HasSubstr("G1 X6 F100\nG99 G81 X10 Y0 Z-4 R2 F100\nG80\nG0 Z30\n"));
}

}  // namespace
}  // namespace kerf::drilling_cycles_test
