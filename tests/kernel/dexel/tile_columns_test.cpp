// SPDX-License-Identifier: Apache-2.0
// Copies of a block that exchange columns converge to the same block, in any order.

#include "kernel/dexel/tile_columns.h"

#include "kernel/dexel/dexel_field.h"
#include "kernel/dexel/tile_region.h"
#include "kernel/sculpture.h"
#include "kernel/tool/tool_bounds.h"
#include "tests/support/test.h"

namespace kerf::tile_columns_test {
namespace {

Sculpture block(Rays rays) {
  auto s = *Sculpture::create({.stock = BoxStock{{0, 0, 0}, {30, 22, 12}},
                               .rays = rays,
                               .pitch_mm = 0.4,
                               .keep_normals = false});
  s.apply(DefineTool{1, *make_tool(BallShape{5, 40})}).value();
  return s;
}

/// Slots at random heights, so that columns are split; some of them tilted.
MoveTool random_move(std::mt19937& random) {
  std::uniform_real_distribution<double> x(-2, 32), y(-2, 24), z(-1, 13), tilt(-0.5, 0.5);
  const auto pose = [&] {
    const Vec3 axis{tilt(random), tilt(random), 1};
    return ToolPose{{x(random), y(random), z(random)}, axis * (1 / length(axis))};
  };
  return {1, pose(), pose(), 0.01, false};
}

TileColumns columns_of(const DexelField& field, TileIndex at) {
  TileColumns columns;
  const auto tile = field.fresh(at);
  std::vector<Dexel> scratch;
  for (int place = 0; place < kTileColumns; ++place) {
    tile->read(place, scratch);
    columns.add(place, scratch);
  }
  return columns;
}

void take_all(Sculpture& to, const Sculpture& from) {
  for (const RayAxis axis : {RayAxis::kZ, RayAxis::kX, RayAxis::kY}) {
    const DexelField* field = from.field(axis);
    if (field == nullptr) continue;
    const DexelGrid& grid = field->grid();
    TileRegion{{0, 0}, {grid.tiles_x(), grid.tiles_y()}}.all_of([&](TileIndex at) {
      to.keep_common({axis, at}, columns_of(*field, at));
      return true;
    });
  }
}

class KeepCommon : public testing::TestWithParam<Rays> {};

TEST_P(KeepCommon, CopiesConvergeToAllCuts) {
  std::mt19937 random(1);
  for (int round = 0; round < 5; ++round) {
    auto both = block(GetParam()), a = block(GetParam()), b = block(GetParam());
    for (int n = 0; n < 12; ++n) {
      const MoveTool move = random_move(random);
      both.apply(move).value();
      (n % 2 == 0 ? a : b).apply(move).value();
    }
    auto old = block(GetParam());
    take_all(a, b);
    EXPECT_EQ(a.state_hash(), both.state_hash());
    take_all(a, old);  // an old state changes nothing
    take_all(a, b);
    EXPECT_EQ(a.state_hash(), both.state_hash());
    take_all(b, a);
    EXPECT_EQ(b.state_hash(), both.state_hash());
  }
}

TEST_P(KeepCommon, LaterMotionsCutTheMergedState) {
  std::mt19937 random(2);
  auto both = block(GetParam()), a = block(GetParam()), b = block(GetParam());
  const MoveTool first = random_move(random), second = random_move(random);
  both.apply(first).value();
  b.apply(first).value();
  take_all(a, b);
  EXPECT_EQ(a.apply(second).value().removed_mm3, both.apply(second).value().removed_mm3);
  EXPECT_EQ(a.state_hash(), both.state_hash());
}

INSTANTIATE_TEST_SUITE_P(Rays, KeepCommon, testing::Values(Rays::kDexel, Rays::kTriDexel));

TEST(KeepCommonOfSome, LeavesOtherColumnsAndTilesUnchanged) {
  auto a = block(Rays::kDexel);
  const std::uint64_t before = a.state_hash();
  TileColumns one;
  one.add(5, std::vector<Dexel>{{0, 1}});
  a.keep_common({RayAxis::kZ, {0, 0}}, one);
  std::vector<Dexel> scratch;
  const DexelSnapshot now = a.snapshot();
  EXPECT_EQ(now.column(5, 0, scratch).back(), (Dexel{0, 1}));
  EXPECT_EQ(now.column(6, 0, scratch).back().top, now.grid().height_quanta);

  auto untouched = block(Rays::kDexel);
  untouched.keep_common({RayAxis::kZ, {0, 99}}, one);
  untouched.keep_common({RayAxis::kX, {0, 0}}, one);
  untouched.keep_common({RayAxis::kZ, {-1, 0}}, one);
  EXPECT_EQ(untouched.state_hash(), before);
}

TEST(CutTiles, ListsTilesOfEveryField) {
  auto s = block(Rays::kTriDexel);
  const auto cut = s.apply(MoveTool{1, {{3, 3, 10}, {0, 0, 1}}, {{4, 3, 10}, {0, 0, 1}}, 0, false});
  for (const RayAxis axis : {RayAxis::kZ, RayAxis::kX, RayAxis::kY}) {
    const bool named = std::ranges::count(cut->cut_tiles, axis, &FieldTile::axis) > 0;
    EXPECT_TRUE(named) << static_cast<int>(axis);
  }
  EXPECT_TRUE(std::ranges::count(cut->cut_tiles, FieldTile{RayAxis::kZ, {0, 0}}) > 0);
  const auto again =
      s.apply(MoveTool{1, {{3, 3, 10}, {0, 0, 1}}, {{4, 3, 10}, {0, 0, 1}}, 0, false});
  EXPECT_TRUE(again->cut_tiles.empty());
}

TEST(TilesThrough, AreTheTilesWhoseRaysMeetTheBox) {
  const auto s = block(Rays::kTriDexel);  // tiles of 12.8 mm: 3 x 2 along Z
  const DexelGrid& grid = s.grid();
  const auto tiles = [&](Vec3 lo, Vec3 hi) { return tiles_through(grid, lo, hi); };
  const TileRegion all = tiles({-5, -5, -5}, {50, 50, 50});
  EXPECT_EQ(all.begin, (TileIndex{0, 0}));
  EXPECT_EQ(all.end, (TileIndex{3, 2}));
  const TileRegion one = tiles({13, 1, 1}, {14, 2, 2});
  EXPECT_EQ(one.begin, (TileIndex{1, 0}));
  EXPECT_EQ(one.end, (TileIndex{2, 1}));
  EXPECT_FALSE(tiles({13, 1, 20}, {14, 2, 30}).has({1, 0})) << "above the block";
  EXPECT_FALSE(tiles({60, 1, 1}, {70, 2, 2}).has({2, 0})) << "beside the block";
  const TileRegion along_x = tiles_through(s.field(RayAxis::kX)->grid(), {13, 1, 1}, {14, 2, 2});
  EXPECT_EQ(along_x.begin, (TileIndex{0, 0}));
  EXPECT_EQ(along_x.end, (TileIndex{1, 1}));
}

TEST(ToolBounds, ContainTheWholeToolAtAnyTilt) {
  const Tool tool = *make_tool(BallShape{10, 50}, {.shank = Shank{4, 20}, .holder = {}});
  const Bounds up = tool_bounds(tool, {{1, 2, 3}, {0, 0, 1}});
  EXPECT_EQ(up.lo_mm, (Vec3{-4, -3, 3}));
  EXPECT_EQ(up.hi_mm, (Vec3{6, 7, 73}));
  const Bounds lying = tool_bounds(tool, {{1, 2, 3}, {1, 0, 0}});
  EXPECT_EQ(lying.lo_mm, (Vec3{1, -3, -2}));
  EXPECT_EQ(lying.hi_mm, (Vec3{71, 7, 8}));
}

}  // namespace
}  // namespace kerf::tile_columns_test
