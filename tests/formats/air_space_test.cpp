// SPDX-License-Identifier: Apache-2.0
#include "server/verify/air_space.h"

#include "kernel/sculpture.h"
#include "tests/support/straight_move.h"
#include "tests/support/test.h"

namespace kerf::air_space_test {
namespace {

using test::move_between;

SculptureSettings block() {
  return SculptureSettings{.stock = BoxStock{{0, 0, -10}, {10, 10, 0}}, .pitch_mm = 0.5};
}
const Tool kTool = *make_tool(BallShape{4, 40});

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

}  // namespace
}  // namespace kerf::air_space_test
