// SPDX-License-Identifier: Apache-2.0
#include "server/feed/changed_columns.h"

#include "kernel/sculpture.h"
#include "server/feed/tile_feed.h"
#include "tests/support/test.h"

namespace kerf::changed_columns_test {
namespace {

const BoxStock kBlock{{0, 0, 0}, {96, 96, 8}};  // 6 x 6 tiles of 16 mm

void cut(Sculpture& sculpture, Vec3 tip) {
  ASSERT_TRUE(sculpture.apply(MoveTool{1, {tip}, {tip}, 1, false}));
}

Sculpture block(Rays rays = Rays::kDexel) {
  Sculpture sculpture =
      std::move(Sculpture::create({.stock = kBlock, .rays = rays, .pitch_mm = 0.5}).value());
  EXPECT_TRUE(sculpture.apply(DefineTool{1, make_tool(BallShape{4, 40}).value()}));
  return sculpture;
}

TEST(ChangedColumns, AreTheRectangleReachedByACut) {
  Sculpture sculpture = block();
  cut(sculpture, {40, 40, 6});  // the middle of tile (2, 2), which is stored from now on
  const SolidSnapshot before = sculpture.solid();
  EXPECT_TRUE(changed_columns(before, before, std::vector<TileIndex>{{2, 2}}).empty());
  cut(sculpture, {36, 40, 6});
  const auto changed = changed_columns(before, sculpture.solid(), std::vector<TileIndex>{{2, 2}});
  ASSERT_EQ(changed.size(), 1U);
  EXPECT_EQ(changed[0].tile, (TileIndex{2, 2}));
  // The ball has a radius of 2 mm: columns of 0.5 mm from 34 to 38, in a tile that begins at 32.
  EXPECT_GE(changed[0].begin_x, 3);
  EXPECT_LE(changed[0].begin_x, 5);
  EXPECT_GE(changed[0].end_x, 10);
  EXPECT_LE(changed[0].end_x, 13);
  EXPECT_GE(changed[0].begin_y, 11);
  EXPECT_LE(changed[0].end_y, 21);
}

TEST(ChangedColumns, CoverNewTilesAndTilesOfThreeFields) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    Sculpture sculpture = block(rays);
    if (rays == Rays::kTriDexel) cut(sculpture, {36, 40, 6});
    const SolidSnapshot before = sculpture.solid();
    cut(sculpture, {40, 40, 6});
    const auto changed = changed_columns(before, sculpture.solid(), std::vector<TileIndex>{{2, 2}});
    ASSERT_EQ(changed.size(), 1U);
    EXPECT_EQ(changed[0].begin_x, 0);
    EXPECT_EQ(changed[0].end_x, kTileSide);
    EXPECT_EQ(changed[0].begin_y, 0);
    EXPECT_EQ(changed[0].end_y, kTileSide);
  }
}

TEST(ChangedColumns, DifferWhereOnlyALowerElementOrItsNormalsDo) {
  Sculpture sculpture = block();
  const auto sideways = [&](double z) {  // a tunnel along x, which divides its columns
    ASSERT_TRUE(
        sculpture.apply(MoveTool{1, {{38, 40, z}, {1, 0, 0}}, {{38, 40, z}, {1, 0, 0}}, 1, false}));
  };
  sideways(4);
  const SolidSnapshot before = sculpture.solid();
  sideways(3.5);  // below the topmost elements
  const auto changed = changed_columns(before, sculpture.solid(), std::vector<TileIndex>{{2, 2}});
  ASSERT_EQ(changed.size(), 1U);
  EXPECT_LT(changed[0].begin_y, 16);
  EXPECT_GT(changed[0].end_y, 16);
}

TEST(TileFeed, MeshesTheNeighborsOfACutTileOnlyIfTheyReadTheChangedColumns) {
  Sculpture sculpture = block();
  cut(sculpture, {40, 40, 6});
  TileFeed feed(sculpture.solid(), sculpture.motions());
  const ViewerId viewer = feed.add_viewer();
  const auto meshed = [&] {
    const auto before = feed.stats().tiles_meshed;
    while (const auto frame = feed.next_frame(viewer)) feed.ack(viewer, frame->sequence);
    return feed.stats().tiles_meshed - before;
  };
  EXPECT_EQ(meshed(), 36U);
  const auto cut_at = [&](Vec3 tip, const std::vector<TileIndex>& tiles) {
    cut(sculpture, tip);
    feed.note_change(sculpture.solid(), tiles, sculpture.motions());
    return meshed();
  };
  EXPECT_EQ(cut_at({38, 40, 5}, {{2, 2}}), 1U) << "far from all borders";
  EXPECT_EQ(cut_at({45, 40, 6}, {{2, 2}}), 2U) << "near the next tile along x";
  EXPECT_EQ(cut_at({35, 35, 6}, {{2, 2}}), 4U) << "near a corner";
  EXPECT_EQ(cut_at({38, 40, 7}, {{2, 2}}), 0U) << "in air";
}

}  // namespace
}  // namespace kerf::changed_columns_test
