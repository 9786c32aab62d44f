// SPDX-License-Identifier: Apache-2.0
// An agent's copy of the block is right where its tool is and where it will be, told no more than
// it needs.

#include "server/feed/stock_feed.h"

#include <gtest/gtest.h>

#include "kernel/dexel/dexel_field.h"
#include "kernel/dexel/tile_region.h"
#include "server/convert/stock_columns.h"
#include "server/wire/limits.h"

namespace kerf {
namespace {

constexpr Vec3 kUp{0, 0, 1};

Sculpture block(Rays rays) {
  SculptureSettings settings;
  settings.stock = BoxStock{{0, 0, -20}, {400, 100, 0}};
  settings.pitch_mm = 0.5;  // tiles of 16 mm
  settings.rays = rays;
  settings.keep_normals = false;
  auto s = *Sculpture::create(settings);
  s.apply(DefineTool{1, *make_tool(BallShape{6, 40})}).value();
  return s;
}

/// The server's block, an agent's feed and its copy.
class StockFeedRoom : public testing::TestWithParam<Rays> {
 protected:
  void own(Vec3 from, Vec3 to) {
    tip_ = to;
    const MoveTool move{1, {from, kUp}, {to, kUp}, 0.001, false};
    server_.apply(move).value();
    copy_.apply(move).value();
  }
  void others(Vec3 from, Vec3 to) {
    const auto cut = server_.apply(MoveTool{1, {from, kUp}, {to, kUp}, 0.001, false});
    feed_.note_cut(cut->cut_tiles);
  }
  std::optional<StockUpdate> next(Vec3 tip, bool acknowledge = true) {
    tip_ = tip;
    time_us_ += 20'000;
    auto news = feed_.next(server_, {*server_.tool(1), {tip, kUp}, time_us_});
    if (news && acknowledge) {
      EXPECT_TRUE(feed_.ack(news->sequence));
    }
    return news;
  }
  void merge(const StockUpdate& news) {
    for (const StockUpdate::Tile& tile : news.tiles) {
      const auto columns = decode_columns(tile.columns);
      ASSERT_TRUE(columns) << columns.error();
      copy_.keep_common(tile.at, *columns);
    }
  }
  void follow(Vec3 tip) {
    for (int n = 0; n < 100; ++n) {
      const auto news = next(tip);
      if (!news) return;
      merge(*news);
    }
    FAIL() << "the feed never ends";
  }
  /// The copy is the server's block wherever the tool may touch it now.
  void expect_right_near(Vec3 tip) {
    const Bounds near = grown(tool_bounds(*server_.tool(1), {tip, kUp}), 5);
    for (const RayAxis axis : {RayAxis::kZ, RayAxis::kX, RayAxis::kY}) {
      const DexelField* field = server_.field(axis);
      if (field == nullptr) continue;
      tiles_through(field->grid(), near.lo_mm, near.hi_mm).all_of([&](TileIndex at) {
        const auto mine = copy_.field(axis)->fresh(at), theirs = field->fresh(at);
        EXPECT_TRUE(encode_columns(*mine, theirs.get()).empty()) << at.x << ' ' << at.y;
        return true;
      });
    }
  }

  Sculpture server_ = block(GetParam()), copy_ = block(GetParam());
  StockFeed feed_;
  Vec3 tip_;
  std::uint64_t time_us_ = 0;
};

TEST_P(StockFeedRoom, TellsWhatWasCutBeforeTheAgentCame) {
  server_.apply(MoveTool{1, {{20, 20, -3}, kUp}, {{60, 50, -3}, kUp}, 0, false}).value();
  follow({30, 30, 2});
  expect_right_near({30, 30, 2});
}

TEST_P(StockFeedRoom, TellsWhatOthersCutNearTheTool) {
  follow({30, 30, 2});
  own({30, 30, -2}, {36, 30, -2});
  others({33, 25, -4}, {33, 40, -4});
  follow({36, 30, -2});
  expect_right_near({36, 30, -2});
  EXPECT_FALSE(next({36, 30, -2})) << "once is enough";
}

TEST_P(StockFeedRoom, SaysNothingOfTheAgentsOwnCuts) {
  follow({30, 30, 2});
  own({30, 30, -2}, {36, 30, -2});
  if (const auto news = next({36, 30, -2})) {  // of tiles that have come near
    for (const StockUpdate::Tile& tile : news->tiles) EXPECT_TRUE(tile.columns.empty());
  }
  expect_right_near({36, 30, -2});
}

TEST_P(StockFeedRoom, SaysNothingOfWhatIsFarAway) {
  follow({30, 30, 2});
  others({350, 90, -4}, {380, 90, -4});
  EXPECT_FALSE(next({30, 30, 2}));
  follow({360, 90, -1});
  expect_right_near({360, 90, -1});
}

TEST_P(StockFeedRoom, LooksAhead) {
  others({150, 50, -4}, {200, 50, -4});
  tip_ = {100, 50, -1};
  follow({100, 50, -1});
  const auto has_far = [&](const StockUpdate& news) {
    return std::ranges::any_of(news.tiles, [](const StockUpdate::Tile& tile) {
      return tile.at.axis == RayAxis::kZ && tile.at.tile.x >= 9;
    });
  };
  // 2 mm in 20 ms: 40 mm in the 0.4 s ahead.
  bool told = false;
  for (int n = 1; n <= 4; ++n) {
    const auto news = next({100.0 + 2 * n, 50, -1});
    if (!news) continue;
    merge(*news);
    told = told || has_far(*news);
  }
  EXPECT_TRUE(told);
  expect_right_near({140, 50, -1});
}

TEST_P(StockFeedRoom, HasSoManyPatchesUnderWayAtMost) {
  std::vector<StockUpdate> way;
  for (int n = 0; n < 40; ++n) {
    others({60, 50, -1 - 0.2 * n}, {60.5, 50, -1 - 0.2 * n});
    if (auto news = next({60, 50, 5}, false)) way.push_back(std::move(*news));
  }
  ASSERT_EQ(way.size(), std::size_t{wire::kStockFramesInFlight});
  EXPECT_EQ(way[0].sequence, 1U);
  EXPECT_TRUE(way[0].reset);
  EXPECT_FALSE(way[1].reset);
  EXPECT_FALSE(feed_.ack(17)) << "was never sent";
  EXPECT_TRUE(feed_.ack(3));
  EXPECT_TRUE(feed_.ack(2)) << "an old one is no mistake";
  for (int n = 0; n < 10; ++n) {
    others({60, 50, -10 - 0.2 * n}, {60.5, 50, -10 - 0.2 * n});
    if (auto news = next({60, 50, 5}, false)) way.push_back(std::move(*news));
  }
  EXPECT_EQ(way.size(), std::size_t{wire::kStockFramesInFlight} + 3);
}

TEST_P(StockFeedRoom, HasSoManyBytesUnderWayAtMost) {
  for (double y = 2; y < 100; y += 2) others({0, y, -4}, {400, y + 1, -5});
  std::size_t bytes = 0;
  for (int n = 0; n < 10; ++n) {
    const auto news = next({40.0 + 30 * n, 50, -1}, false);
    if (!news) continue;
    for (const StockUpdate::Tile& tile : news->tiles) bytes += tile.columns.size();
  }
  EXPECT_GT(bytes, wire::kStockBytesInFlight);
  EXPECT_LT(bytes, wire::kStockBytesInFlight + 2 * StockFeed::kPatchBytes);
  EXPECT_TRUE(feed_.ack(2));
  EXPECT_TRUE(next({360, 50, -1}));
}

TEST_P(StockFeedRoom, ResetsTheCopy) {
  others({20, 20, -4}, {60, 50, -4});
  follow({30, 30, 2});
  own({30, 30, -3}, {30, 30, -8});
  copy_ = block(GetParam());
  feed_.restart();
  const auto news = next({30, 30, -8});
  ASSERT_TRUE(news);
  EXPECT_TRUE(news->reset);
  EXPECT_EQ(news->agent_time_us, time_us_);
  merge(*news);
  follow({30, 30, -8});
  expect_right_near({30, 30, -8});
}

TEST_P(StockFeedRoom, SendsTheNearestTilesFirst) {
  for (double y = 2; y < 100; y += 2) others({0, y, -4}, {400, y + 1, -5});
  const auto news = next({200, 50, -1});
  ASSERT_TRUE(news);
  ASSERT_FALSE(news->tiles.empty());
  const FieldTile first = news->tiles.front().at;
  if (first.axis == RayAxis::kZ) {
    EXPECT_EQ(first.tile, (TileIndex{12, 3}));
  }
  merge(*news);
  follow({200, 50, -1});
  expect_right_near({200, 50, -1});
}

TEST_P(StockFeedRoom, FollowsALongWalkAmongOthers) {
  for (int n = 0; n < 300; ++n) {
    const double x = 20 + n, y = 50 + 30 * ((n % 20) / 20.0);
    own(tip_ == Vec3{} ? Vec3{x, y, -2} : tip_, {x, y, -2.0 - n % 3});
    others({x + 8, y - 10, -4}, {x + 8, y + 10, -1.0 - n % 5});
    if (const auto news = next({x, y, -2.0 - n % 3})) merge(*news);
  }
  follow(tip_);
  expect_right_near(tip_);
}

TEST(StockFeed, DoesNotLookAtMoreTilesThanItHasTimeFor) {
  SculptureSettings settings;
  settings.stock = BoxStock{{0, 0, -20}, {400, 400, 0}};
  settings.pitch_mm = 0.01;  // tiles of 0.32 mm
  settings.keep_normals = false;
  auto server = *Sculpture::create(settings);
  server.apply(DefineTool{1, *make_tool(BallShape{6, 40})}).value();
  server.apply(DefineTool{2, *make_tool(BallShape{60, 80})}).value();
  StockFeed feed;
  const ToolPose middle{{200, 200, -1}, kUp};
  const auto news = feed.next(server, {*server.tool(1), middle, 1000});
  ASSERT_TRUE(news);
  EXPECT_LT(news->tiles.size(), 4097U);
  EXPECT_FALSE(feed.next(server, {*server.tool(2), middle, 21'000})) << "225 x 225 tiles";
  EXPECT_TRUE(feed.next(server, {*server.tool(1), {{150, 200, -1}, kUp}, 41'000}))
      << "50 mm ahead are too many, those around the tool are not";
}

INSTANTIATE_TEST_SUITE_P(Rays, StockFeedRoom, testing::Values(Rays::kDexel, Rays::kTriDexel));

}  // namespace
}  // namespace kerf
