// SPDX-License-Identifier: Apache-2.0
#include "server/formats/arc_fit.h"

#include "server/formats/pose_grid.h"
#include "server/formats/program_writer.h"
#include "server/formats/units.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::arc_fit_test {
namespace {

using test::scene_for;
using testing::HasSubstr;
using testing::Not;

// Points of an arc about (1, 2) in XY, rising evenly.
std::vector<ToolPose> arc_path(double radius, double from_deg, double to_deg, int chords,
                               double rise = 0) {
  std::vector<ToolPose> path;
  for (int i = 0; i <= chords; ++i) {
    const double s = static_cast<double>(i) / chords;
    const double a = kRadPerDeg * (from_deg + (to_deg - from_deg) * s);
    path.push_back(
        admit_pose({{1 + radius * std::cos(a), 2 + radius * std::sin(a), rise * s}, {0, 0, 1}}));
  }
  return path;
}

Program program_of(const std::vector<ToolPose>& path) {
  Program program;
  for (std::size_t i = 1; i < path.size(); ++i)
    program.motions.push_back({.tool = 1, .from = path[i - 1], .to = path[i], .duration_s = 0.1});
  return program;
}

TEST(ArcFit, FindsCenterAndDirection) {
  for (const double to : {200.0, -70.0}) {
    const auto arc = test::value_of(fit_arc(arc_path(10, 30, to, 40), 0.03));
    EXPECT_EQ(arc.plane, ArcPlane::kXy);
    EXPECT_NEAR(arc.center.first, 1, 1e-4);
    EXPECT_NEAR(arc.center.second, 2, 1e-4);
    EXPECT_EQ(arc.counterclockwise, to > 30);
    EXPECT_FALSE(arc.helical);
  }
  EXPECT_TRUE(test::value_of(fit_arc(arc_path(10, 0, 200, 40, -3), 0.03)).helical);
}

TEST(ArcFit, RejectsOtherPaths) {
  EXPECT_FALSE(fit_arc(arc_path(10, 0, 90, 2), 1));      // too few points
  EXPECT_FALSE(fit_arc(arc_path(10, 0, 350, 60), 0.1));  // nearly a whole turn
  EXPECT_FALSE(fit_arc(arc_path(10, 0, 240, 4), 9));     // a polygon
  EXPECT_FALSE(fit_arc(arc_path(10, 0, 90, 6), 0.01));   // chords 0.09 mm inside
  auto bent = arc_path(10, 0, 90, 40);
  bent[25].tip_mm.x += 0.1;
  EXPECT_FALSE(fit_arc(bent, 0.05));
  auto stepped = arc_path(10, 0, 90, 40);
  for (std::size_t i = 20; i < stepped.size(); ++i) stepped[i].tip_mm.z += 0.2;
  EXPECT_FALSE(fit_arc(stepped, 0.05));
  auto tilted = arc_path(10, 0, 90, 40);
  tilted[7].axis = {0, 0.6, 0.8};
  EXPECT_FALSE(fit_arc(tilted, 0.05));
}

std::string written(const Program& program, Post post, double tolerance_mm) {
  std::ostringstream out;
  const Scene scene = scene_for("xyz");
  auto writer = make_program_writer({.post = post, .tolerance_mm = tolerance_mm}, scene, out);
  EXPECT_TRUE(writer);
  EXPECT_TRUE(write_program(program, **writer));
  return out.str();
}

Program read_as(const std::string& text, Post post) {
  GcodeEnvironment environment{.dialect = *dialect_of(rules_of(post).name)};
  const auto read = parse_program("p.nc", text, scene_for("xyz"), environment);
  EXPECT_TRUE(read) << to_string(read.error()) << text;
  return read ? *read : Program{};
}

// Reading an arc back gives points on the circle whose distance follows the scene's tolerance.
TEST(ArcFit, EveryControlReadsItsArcsBack) {
  for (const Post post :
       {Post::kLinuxcnc, Post::kGrbl, Post::kFanuc, Post::kHaas, Post::kHeidenhain})
    for (const double rise : {0.0, -4.0}) {
      const auto path = arc_path(10, 20, 290, 90, rise);
      const std::string text = written(program_of(path), post, 0.02);
      const bool helix_as_lines = post == Post::kHeidenhain && rise != 0;
      const char* arc = post == Post::kHeidenhain ? " DR+" : "G3 ";
      if (!helix_as_lines) {
        EXPECT_THAT(text, HasSubstr(arc));
      }
      const Program read = read_as(text, post);
      double seconds = 0;
      for (const ProgramMotion& motion : read.motions) {
        seconds += motion.duration_s;
        const Vec3 p = motion.to.tip_mm;
        EXPECT_NEAR(std::hypot(p.x - 1, p.y - 2), 10, 0.022) << text;
      }
      EXPECT_NEAR(seconds, 9, 0.05);
      EXPECT_LT(length(read.motions.back().to.tip_mm - path.back().tip_mm), 1e-3);
    }
}

TEST(ArcFit, OtherPlanesAreSelectedAndLeftAgain) {
  std::vector<ToolPose> path;
  for (const ToolPose& pose : arc_path(10, 20, 160, 60))
    path.push_back({{pose.tip_mm.x, 0, pose.tip_mm.y - 30}, {0, 0, 1}});
  const std::string text = written(program_of(path), Post::kFanuc, 0.02);
  EXPECT_THAT(text, HasSubstr("G18\nG2 "));
  EXPECT_THAT(text, HasSubstr("G17\nG91 G28"));
  const Program read = read_as(text, Post::kFanuc);
  double top = -100;
  for (const ProgramMotion& motion : read.motions) top = std::max(top, motion.to.tip_mm.z);
  EXPECT_NEAR(top, -18, 0.03);
  EXPECT_THAT(written(program_of(path), Post::kHeidenhain, 0.02), Not(HasSubstr("CC")));
}

TEST(ArcFit, WithoutAToleranceMotionsAreNotJoined) {
  EXPECT_THAT(written(program_of(arc_path(10, 20, 290, 90)), Post::kFanuc, 0),
              Not(HasSubstr("G3")));
}

// A line, an arc and a line: each is one block.
TEST(ArcFit, LinesAndArcsAreDistinguished) {
  auto path = arc_path(10, 0, 90, 40);
  path.insert(path.begin(), ToolPose{{11, -20, 0}, {0, 0, 1}});
  path.push_back({{-30, 12, 0}, {0, 0, 1}});
  const std::string text = written(program_of(path), Post::kLinuxcnc, 0.003);
  EXPECT_THAT(text, HasSubstr("G1 Y2 F"));
  EXPECT_THAT(text, HasSubstr("\nG3 X1 Y12 I-"));
  EXPECT_THAT(text, HasSubstr("\nG1 X-30 F"));
}

}  // namespace
}  // namespace kerf::arc_fit_test
