// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program_path.h"

#include "tests/support/test.h"

namespace kerf::program_path_test {
namespace {

/// A program through `points`. The line of a motion is its number.
Program through(const std::vector<Vec3>& points, bool rapid = false) {
  Program program;
  for (std::size_t n = 1; n < points.size(); ++n) {
    ProgramMotion motion{.tool = 1,
                         .from = {.tip_mm = points[n - 1]},
                         .to = {.tip_mm = points[n]},
                         .duration_s = 1,
                         .line = static_cast<std::uint32_t>(n),
                         .rapid = rapid};
    program.motions.push_back(motion);
  }
  return program;
}

double distance_mm(Vec3 point, Vec3 from, Vec3 to) {
  const Vec3 along = to - from;
  const double square = dot(along, along);
  const double s = square > 0 ? std::clamp(dot(point - from, along) / square, 0.0, 1.0) : 0;
  return length(point - (from + along * s));
}

/// The greatest distance of the program's points from the drawn path, by brute force.
double error_of(const Program& program, const ProgramPath& path) {
  double worst = 0;
  for (const ProgramMotion& motion : program.motions) {
    double nearest = 1e300;
    for (std::size_t n = 1; n < path.points.size(); ++n) {
      if (path.points[n].kind == PathKind::kStart) continue;
      nearest = std::min(
          nearest, distance_mm(motion.to.tip_mm, path.points[n - 1].tip_mm, path.points[n].tip_mm));
    }
    worst = std::max(worst, nearest);
  }
  return worst;
}

TEST(ProgramPath, AStraightLineKeepsItsEnds) {
  std::vector<Vec3> points;
  for (int n = 0; n <= 1000; ++n) points.push_back({0.5 * n, 0, 0});
  const ProgramPath path = drawn_path(through(points), 10);
  ASSERT_EQ(path.points.size(), 2U);
  EXPECT_EQ(path.points[0], (PathPoint{{0, 0, 0}, 1, 1, PathKind::kStart}));
  EXPECT_EQ(path.points[1], (PathPoint{{500, 0, 0}, 1000, 1, PathKind::kFeed, 1000}));
  EXPECT_EQ(path.error_mm, 0);
}

TEST(ProgramPath, ALineThatTurnsBackKeepsTheTurn) {
  const ProgramPath path = drawn_path(through({{0, 0, 0}, {9, 0, 0}, {2, 0, 0}, {5, 0, 0}}), 10);
  ASSERT_EQ(path.points.size(), 4U);
  EXPECT_EQ(path.points[1].tip_mm.x, 9);
  EXPECT_EQ(path.points[2].tip_mm.x, 2);
}

TEST(ProgramPath, RapidsToolsAndJumpsSeparateRuns) {
  Program program = through({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {5, 0, 0}});
  program.motions[1].rapid = true;
  program.motions[3].tool = 2;
  program.motions[4].tool = 2;
  program.motions[4].from.tip_mm = {4, 7, 0};
  const ProgramPath path = drawn_path(program, 100);
  std::string kinds;
  for (const PathPoint& point : path.points) kinds += "srf"[static_cast<int>(point.kind)];
  EXPECT_EQ(kinds, "sfrffsf");
  EXPECT_EQ(path.points[4].tool, 2U);
  EXPECT_EQ(path.points[5].tip_mm.y, 7);
}

TEST(ProgramPath, TheStatedErrorHoldsForAnyNumberOfPoints) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.05);
  std::vector<Vec3> points;
  for (int n = 0; n < 1200; ++n) {
    const double a = n * 0.01;
    points.push_back({20 * std::cos(a) + noise(random), 20 * std::sin(a) + noise(random), a / 3});
  }
  const Program program = through(points);
  double previous_mm = 0;
  for (const std::size_t most : {2000, 600, 200, 60, 12, 3, 2}) {
    const ProgramPath path = drawn_path(program, most);
    EXPECT_LE(path.points.size(), most);
    EXPECT_GE(path.points.size(), 2U);
    EXPECT_LE(error_of(program, path), path.error_mm + 1e-9) << most;
    EXPECT_GE(path.error_mm, previous_mm) << most;
    EXPECT_EQ(path.points.front().tip_mm, points.front());
    EXPECT_EQ(path.points.back().tip_mm, points.back());
    previous_mm = path.error_mm;
    const ProgramPath again = drawn_path(drawn_path(program, 600), most);
    EXPECT_LE(again.points.size(), most);
    EXPECT_LE(error_of(program, again), again.error_mm + 1e-9) << most;
  }
}

TEST(ProgramPath, TooManyCornersAreThinnedEvenly) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-50, 50);
  std::vector<Vec3> points;
  for (int n = 0; n < 5000; ++n) points.push_back({anywhere(random), anywhere(random), 0});
  Program program = through(points);
  program.motions[2500].from.tip_mm.z = 1;
  const ProgramPath path = drawn_path(program, 50);
  EXPECT_LE(path.points.size(), 50U);
  EXPECT_GE(path.points.size(), 25U);
  EXPECT_EQ(path.points.back().tip_mm, points.back());
  EXPECT_LE(error_of(program, path), path.error_mm);
  int starts = 0;
  for (const PathPoint& point : path.points) starts += point.kind == PathKind::kStart ? 1 : 0;
  EXPECT_EQ(starts, 2);
}

TEST(ProgramPath, AnEmptyProgramHasNoPath) {
  EXPECT_TRUE(drawn_path(Program{}, 10).points.empty());
}

}  // namespace
}  // namespace kerf::program_path_test
