// SPDX-License-Identifier: Apache-2.0
#include "server/session/air_path.h"

#include "tests/support/straight_move.h"
#include "tests/support/test.h"

namespace kerf::air_path_test {
namespace {

using test::move_between;

TEST(AirPath, JoinsAStraightLineAtOneSpeed) {
  AirPath path;
  for (int i = 0; i < 100; ++i) {
    // Points of a slanted line, rounded as by a sampler.
    const auto at = [](int n) {
      return Vec3{std::round(n * 1e6 / 7) / 1e6, std::round(n * 1e6 / 3) / 1e6, 5};
    };
    ASSERT_TRUE(path.add(move_between(at(i), at(i + 1)))) << i;
  }
  EXPECT_EQ(path.joined()->from.tip_mm, (Vec3{0, 0, 5}));
  EXPECT_NEAR(path.joined()->to.tip_mm.y, 100.0 / 3, 1e-6);
  EXPECT_NEAR(path.joined()->duration_s, 10, 1e-9);
  path.clear();
  EXPECT_FALSE(path.joined());
  EXPECT_TRUE(path.add(move_between({1, 1, 5}, {2, 2, 5})));
}

TEST(AirPath, KeepsCornersSpeedsReversalsAndGaps) {
  const MoveTool first = move_between({0, 0, 5}, {1, 0, 5});
  const auto joins = [&](MoveTool next) {
    AirPath path;
    path.add(first);
    return path.add(next);
  };
  EXPECT_TRUE(joins(move_between({1, 0, 5}, {2, 0, 5})));
  EXPECT_FALSE(joins(move_between({1, 0, 5}, {2, 0.1, 5}))) << "a corner";
  EXPECT_FALSE(joins(move_between({1, 0, 5}, {2, 0, 5}, 0.2))) << "half of the speed";
  EXPECT_FALSE(joins(move_between({1, 0, 5}, {0.5, 0, 5}, 0.05))) << "back";
  EXPECT_FALSE(joins(move_between({1.001, 0, 5}, {2, 0, 5}))) << "a gap";
  EXPECT_FALSE(joins(move_between({1, 0, 5}, {1, 0, 5}))) << "a rest";
  MoveTool other = move_between({1, 0, 5}, {2, 0, 5});
  other.tool = 2;
  EXPECT_FALSE(joins(other));
}

/// A circle of short motions must not shrink to its chord, however little each motion turns.
TEST(AirPath, StaysWithinTheToleranceOfACurve) {
  std::vector<Vec3> points;
  for (int i = 0; i <= 5000; ++i) {
    points.push_back({100 * std::cos(i * 0.0002), 100 * std::sin(i * 0.0002), 5});
  }
  AirPath path;
  std::size_t begin = 0, joined = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    if (path.add(move_between(points[i], points[i + 1]))) continue;
    const Vec3 from = path.joined()->from.tip_mm, to = path.joined()->to.tip_mm;
    for (std::size_t n = begin; n <= i; ++n) {
      const Vec3 along = (to - from) * (1 / length(to - from));
      EXPECT_LE(length(cross(points[n] - from, along)), kAirToleranceMm * 1.0001);
    }
    begin = i;
    ++joined;
    path.clear();
    path.add(move_between(points[i], points[i + 1]));
  }
  EXPECT_LT(joined, 400U) << "it does join";
}

}  // namespace
}  // namespace kerf::air_path_test
