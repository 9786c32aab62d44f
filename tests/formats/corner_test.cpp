// SPDX-License-Identifier: Apache-2.0
#include "server/formats/control/corner.h"

#include <gtest/gtest.h>

#include <iterator>

#include "server/formats/control/hole_pattern.h"

namespace kerf::corner_test {
namespace {

constexpr PlanePoint kStart{0, 0, 2}, kCorner{10, 0, 2}, kLeft{10, 10, 2}, kRight{10, -10, 2};

void expect_at(PlanePoint point, double first, double second) {
  EXPECT_NEAR(point.first, first, 1e-12);
  EXPECT_NEAR(point.second, second, 1e-12);
  EXPECT_EQ(point.normal, 2);
}

TEST(Corner, ArcTouchesBothMovesAndTurnsAsTheyDo) {
  const auto left = corner_path(kStart, kCorner, kLeft, {.radius_mm = 3});
  ASSERT_TRUE(left && left->center);
  expect_at(left->start, 7, 0);
  expect_at(left->end, 10, 3);
  expect_at(*left->center, 7, 3);
  EXPECT_EQ(left->turns, 1);
  const auto right = corner_path(kStart, kCorner, kRight, {.radius_mm = 3});
  ASSERT_TRUE(right && right->center);
  expect_at(*right->center, 7, -3);
  EXPECT_EQ(right->turns, -1);
}

TEST(Corner, ChamferHasItsLengthOrThatOfItsLegs) {
  const auto legs = corner_path(kStart, kCorner, kLeft, {.leg_mm = 3});
  ASSERT_TRUE(legs && !legs->center);
  expect_at(legs->start, 7, 0);
  expect_at(legs->end, 10, 3);
  const auto chamfer = corner_path(kStart, kCorner, {20, 10, 2}, {.chamfer_mm = 3});
  ASSERT_TRUE(chamfer);
  EXPECT_NEAR(distance(chamfer->start, chamfer->end), 3, 1e-12);
}

TEST(Corner, MustBeLevelAndFitItsMoves) {
  EXPECT_EQ(corner_path(kStart, kCorner, {10, 10, 1}, {.radius_mm = 3}).error(),
            CornerFault::kNotLevel);
  EXPECT_EQ(corner_path(kStart, kCorner, kLeft, {.radius_mm = 10.1}).error(),
            CornerFault::kTooLarge);
  EXPECT_EQ(corner_path(kStart, kCorner, kStart, {.radius_mm = 1}).error(), CornerFault::kTooLarge);
}

TEST(Corner, StraightMovesHaveNone) {
  const auto path = corner_path(kStart, kCorner, {20, 0, 2}, {.radius_mm = 3});
  ASSERT_TRUE(path);
  EXPECT_TRUE(path->straight_on);
  EXPECT_FALSE(path->center);
  expect_at(path->end, 10, 0);
}

TEST(HolePattern, GridGoesBackAndForthAndTurnsAsAWhole) {
  const auto holes = holes_on_grid(3, 2, 10, 5, 90);
  constexpr double kExpected[][2] = {{0, 0}, {0, 10}, {0, 20}, {-5, 20}, {-5, 10}, {-5, 0}};
  ASSERT_EQ(holes.size(), std::size(kExpected));
  for (std::size_t i = 0; i < holes.size(); ++i) {
    EXPECT_NEAR(holes[i].x, kExpected[i][0], 1e-12) << i;
    EXPECT_NEAR(holes[i].y, kExpected[i][1], 1e-12) << i;
  }
}

TEST(HolePattern, LinesAndCirclesBeginWhereStated) {
  const auto line = holes_on_line(2, 5, 10, 180);
  EXPECT_NEAR(line[0].x, -5, 1e-12);
  EXPECT_NEAR(line[1].x, -15, 1e-12);
  const auto circle = holes_on_circle(4, 5, 90, 90);
  EXPECT_NEAR(circle[0].y, 5, 1e-12);
  EXPECT_NEAR(circle[3].x, 5, 1e-12);
}

}  // namespace
}  // namespace kerf::corner_test
