// SPDX-License-Identifier: Apache-2.0
#include "server/session/air_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kerf {
namespace {

SculptureSettings block() {
  SculptureSettings settings;
  settings.stock = BoxStock{{0, 0, -10}, {10, 10, 0}};
  settings.pitch_mm = 0.5;
  return settings;
}
const Tool kTool = *make_tool(BallShape{4, 40});

MoveTool move_between(Vec3 from, Vec3 to, double duration_s = 0.1, Vec3 axis = {0, 0, 1}) {
  MoveTool move;
  move.tool = 1;
  move.from = {from, axis};
  move.to = {to, axis};
  move.duration_s = duration_s;
  move.feel = false;
  return move;
}

TEST(AirSpace, IsOutsideTheBoxAroundTheStock) {
  const AirSpace air(block());
  const auto is_air = [&](Vec3 from, Vec3 to, Vec3 axis = {0, 0, 1}) {
    return air.contains(move_between(from, to, 1, axis), kTool);
  };
  EXPECT_TRUE(is_air({0, 0, 1}, {10, 10, 1}));
  EXPECT_FALSE(is_air({0, 0, 1}, {10, 10, 0.4})) << "within a pitch of the stock";
  EXPECT_TRUE(is_air({-3, 5, -5}, {-3, 6, -9}));
  EXPECT_FALSE(is_air({-2, 5, -5}, {-3, 6, -9})) << "the radius is 2 mm";
  EXPECT_FALSE(is_air({-3, 5, -50}, {20, 5, -50})) << "the shank is 40 mm long";
  EXPECT_TRUE(is_air({-3, 5, -51}, {20, 5, -51}));
  EXPECT_FALSE(is_air({-20, 5, -5}, {-20, 6, -5}, {1, 0, 0})) << "it lies along X";
  EXPECT_TRUE(is_air({-20, 5, -5}, {-20, 6, -5}, {-1, 0, 0}));
}

TEST(AirSpace, ExcludesTurningAxesFeltMotionsAndScenesWithObstacles) {
  const AirSpace air(block());
  MoveTool move = move_between({0, 0, 5}, {1, 0, 5});
  EXPECT_TRUE(air.contains(move, kTool));
  move.to.axis = {0, 0.6, 0.8};
  EXPECT_FALSE(air.contains(move, kTool));
  move = move_between({0, 0, 5}, {1, 0, 5});
  move.feel = true;
  EXPECT_FALSE(air.contains(move, kTool));
  move.feel = false;
  SculptureSettings settings = block();
  settings.obstacles.emplace_back();
  EXPECT_FALSE(AirSpace(settings).contains(move, kTool));
}

/// No motion in the air space removes anything from the block.
TEST(AirSpace, MotionsInItRemoveNothing) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> at(-60, 60);
  const SculptureSettings settings = block();
  const AirSpace air(settings);
  auto sculpture = *Sculpture::create(settings);
  sculpture.apply(DefineTool{1, kTool}).value();
  const std::uint64_t hash = sculpture.state_hash();
  int in_air = 0, cuts = 0;
  for (int n = 0; n < 4000; ++n) {
    const Vec3 axes[] = {{0, 0, 1}, {1, 0, 0}, {0, -0.6, 0.8}};
    const auto point = [&] { return Vec3{at(random), at(random), at(random)} * 0.5; };
    MoveTool move = move_between(point(), point(), 1, axes[n % 3]);
    if (!air.contains(move, kTool)) {
      ++cuts;
      continue;
    }
    ++in_air;
    EXPECT_EQ(sculpture.apply(move).value().removed_mm3, 0);
  }
  EXPECT_EQ(sculpture.state_hash(), hash);
  EXPECT_GT(in_air, 300);
  EXPECT_GT(cuts, 300);
}

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
}  // namespace kerf
