// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/path_cursor.h"

#include "tests/support/test.h"

namespace kerf::agent::path_cursor_test {
namespace {

const PoseScript kCorner = {
    {.time_s = 5, .tip_mm = {0, 0, 0}, .axis = {0, 0, 1}, .cutting = false},
    {.time_s = 6, .tip_mm = {10, 0, 0}, .axis = {0, 0, 1}, .cutting = true, .tool_id = 2},
    {.time_s = 8, .tip_mm = {10, 0, 0}, .axis = {1, 0, 0}, .cutting = false}};

TEST(PathCursor, TipMovesLinearly) {
  PathCursor cursor(kCorner, false);
  const PathPoint point = cursor.at(0.25);
  EXPECT_EQ(point.tip_mm, (Vec3{2.5, 0, 0}));
  EXPECT_EQ(point.tip_mm_per_s, (Vec3{10, 0, 0}));
  EXPECT_TRUE(point.cutting);
  EXPECT_EQ(point.tool_id, 2U);
}

TEST(PathCursor, AxisTurnsUniformlyOnAGreatCircle) {
  PathCursor cursor(kCorner, false);
  const PathPoint point = cursor.at(1.0 + 2.0 / 3.0);
  EXPECT_NEAR(point.axis.x, 0.5, 1e-12);
  EXPECT_NEAR(point.axis.z, std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(point.turn_rad_per_s.y, std::acos(0.0) / 2, 1e-12);
}

TEST(PathCursor, RestsAtTheEnd) {
  PathCursor cursor(kCorner, false);
  EXPECT_FALSE(cursor.at(2.999).at_end);
  const PathPoint point = cursor.at(100);
  EXPECT_TRUE(point.at_end);
  EXPECT_EQ(point.axis, (Vec3{1, 0, 0}));
  EXPECT_EQ(point.tip_mm_per_s, (Vec3{}));
}

TEST(PathCursor, StepLeavingACutCuts) {
  PathCursor cursor(kCorner, false);
  cursor.at(0.999);
  EXPECT_TRUE(cursor.at(1.001).cutting);
  EXPECT_FALSE(cursor.at(1.002).cutting);
}

TEST(PathCursor, SpeedScalesTime) {
  PathCursor cursor(kCorner, false, 4.0);
  EXPECT_DOUBLE_EQ(cursor.duration_s(), 0.75);
  EXPECT_EQ(cursor.at(0.125).tip_mm, (Vec3{5, 0, 0}));
}

TEST(PathCursor, LoopReturnsWithoutCutting) {
  PathCursor cursor(kCorner, true);
  const double lap_s = cursor.duration_s();
  EXPECT_GT(lap_s, 3.0);
  cursor.at(3.0);
  const PathPoint home = cursor.at(3.0 + (lap_s - 3.0) / 2);
  EXPECT_FALSE(home.cutting);
  EXPECT_NEAR(home.tip_mm.x, 5.0, 1e-9);
  const PathPoint second = cursor.at(lap_s + 0.25);
  EXPECT_NEAR(second.tip_mm.x, 2.5, 1e-9);
  EXPECT_FALSE(second.at_end);
  EXPECT_NEAR(cursor.at(7 * lap_s + 0.5).tip_mm.x, 5.0, 1e-9);
}

TEST(PathCursor, SinglePoseEndsImmediately) {
  PathCursor cursor({{.tip_mm = {1, 2, 3}}}, true);
  EXPECT_TRUE(cursor.at(0).at_end);
  EXPECT_EQ(cursor.at(10).tip_mm, (Vec3{1, 2, 3}));
}

}  // namespace
}  // namespace kerf::agent::path_cursor_test
