// SPDX-License-Identifier: Apache-2.0
// StockFeed keeps an agent's replica correct around its tool and its predicted path, and sends no
// more than necessary.

#include "server/feed/stock_feed.h"

#include "kernel/dexel/dexel_field.h"
#include "kernel/dexel/tile_region.h"
#include "server/convert/stock_columns.h"
#include "server/wire/limits.h"
#include "tests/support/test.h"

namespace kerf::stock_feed_test {
namespace {

constexpr Vec3 kUp{0, 0, 1};

Sculpture block(Rays rays) {
  SculptureSettings settings{.stock = BoxStock{{0, 0, -20}, {400, 100, 0}}};
  settings.pitch_mm = 0.5;  // tiles of 16 mm
  settings.rays = rays;
  settings.keep_normals = false;
  auto s = *Sculpture::create(settings);
  s.apply(DefineTool{1, *make_tool(BallShape{6, 40})}).value();
  return s;
}

/// The server's block, an agent's feed and its replica.
class StockFeedTest : public testing::TestWithParam<Rays> {
 protected:
  void cut_own(Vec3 from, Vec3 to) {
    tip_ = to;
    const MoveTool move{1, {from, kUp}, {to, kUp}, 0.001, false};
    server_.apply(move).value();
    replica_.apply(move).value();
  }
  void cut_other(Vec3 from, Vec3 to) {
    const auto cut = server_.apply(MoveTool{1, {from, kUp}, {to, kUp}, 0.001, false});
    feed_.note_cut(cut->cut_tiles);
  }
  std::optional<StockUpdate> next(Vec3 tip, bool acknowledge = true) {
    tip_ = tip;
    time_us_ += 20'000;
    auto update = feed_.next(server_, {*server_.tool(1), {tip, kUp}, time_us_});
    if (update && acknowledge) {
      EXPECT_TRUE(feed_.ack(update->sequence));
    }
    return update;
  }
  void merge(const StockUpdate& update) {
    for (const StockUpdate::Tile& tile : update.tiles) {
      const auto columns = test::value_of(decode_columns(tile.columns));
      if (update.returned) bring_back(replica_, tile.at);
      replica_.keep_common(tile.at, columns);
    }
  }
  void follow(Vec3 tip) {
    for (int n = 0; n < 100; ++n) {
      const auto update = next(tip);
      if (!update) return;
      merge(*update);
    }
    FAIL() << "more than 100 patches without a motion";
  }
  static void bring_back(Sculpture& block, FieldTile at) {
    const TileReplacement whole{at, nullptr};
    block.replace({&whole, 1});
  }
  /// Restores all stock of the server's block near a point. Returns the tiles.
  std::vector<FieldTile> undo_near(Vec3 place) {
    std::vector<FieldTile> tiles;
    for (const RayAxis axis : {RayAxis::kZ, RayAxis::kX, RayAxis::kY}) {
      if (server_.field(axis) == nullptr) continue;
      tiles_through(server_.field(axis)->grid(), place, place).all_of([&](TileIndex at) {
        tiles.push_back({axis, at});
        return true;
      });
    }
    for (const FieldTile& at : tiles) bring_back(server_, at);
    feed_.note_returned(tiles);
    return tiles;
  }
  /// Expects that the replica equals the server's block wherever the tool may touch it.
  void expect_equal_near(Vec3 tip) {
    const Bounds near = grown(tool_bounds(*server_.tool(1), {tip, kUp}), 5);
    for (const RayAxis axis : {RayAxis::kZ, RayAxis::kX, RayAxis::kY}) {
      const DexelField* field = server_.field(axis);
      if (field == nullptr) continue;
      tiles_through(field->grid(), near.lo_mm, near.hi_mm).all_of([&](TileIndex at) {
        const auto actual = replica_.field(axis)->fresh(at), expected = field->fresh(at);
        EXPECT_TRUE(encode_columns(*actual, expected.get()).empty()) << at.x << ' ' << at.y;
        return true;
      });
    }
  }

  Sculpture server_ = block(GetParam()), replica_ = block(GetParam());
  StockFeed feed_;
  Vec3 tip_;
  std::uint64_t time_us_ = 0;
};

TEST_P(StockFeedTest, SendsCutsMadeBeforeTheAgentArrived) {
  server_.apply(MoveTool{1, {{20, 20, -3}, kUp}, {{60, 50, -3}, kUp}, 0, false}).value();
  follow({30, 30, 2});
  expect_equal_near({30, 30, 2});
}

TEST_P(StockFeedTest, SendsForeignCutsNearTheTool) {
  follow({30, 30, 2});
  cut_own({30, 30, -2}, {36, 30, -2});
  cut_other({33, 25, -4}, {33, 40, -4});
  follow({36, 30, -2});
  expect_equal_near({36, 30, -2});
  EXPECT_FALSE(next({36, 30, -2})) << "sent already";
}

TEST_P(StockFeedTest, DoesNotSendTheAgentsOwnCuts) {
  follow({30, 30, 2});
  cut_own({30, 30, -2}, {36, 30, -2});
  if (const auto update = next({36, 30, -2})) {  // tiles that the tool approached
    for (const StockUpdate::Tile& tile : update->tiles) EXPECT_TRUE(tile.columns.empty());
  }
  expect_equal_near({36, 30, -2});
}

TEST_P(StockFeedTest, DoesNotSendDistantCuts) {
  follow({30, 30, 2});
  cut_other({350, 90, -4}, {380, 90, -4});
  EXPECT_FALSE(next({30, 30, 2}));
  follow({360, 90, -1});
  expect_equal_near({360, 90, -1});
}

TEST_P(StockFeedTest, SendsTheWholeBlockOnRequest) {
  feed_ = StockFeed(true, true);
  cut_other({350, 90, -4}, {380, 90, -4});
  follow({30, 30, 2});
  EXPECT_EQ(replica_.state_hash(), server_.state_hash());
  cut_other({200, 50, -4}, {220, 50, -4});
  follow({30, 30, 2});
  EXPECT_EQ(replica_.state_hash(), server_.state_hash());
  undo_near({360, 90, -2});
  follow({30, 30, 2});
  EXPECT_EQ(replica_.state_hash(), server_.state_hash());
}

TEST_P(StockFeedTest, SendsTilesAlongThePredictedPath) {
  cut_other({150, 50, -4}, {200, 50, -4});
  tip_ = {100, 50, -1};
  follow({100, 50, -1});
  const auto has_far = [&](const StockUpdate& update) {
    return std::ranges::any_of(update.tiles, [](const StockUpdate::Tile& tile) {
      return tile.at.axis == RayAxis::kZ && tile.at.tile.x >= 9;
    });
  };
  // 2 mm in 20 ms: 40 mm in the prediction time of 0.4 s.
  bool sent_far = false;
  for (int n = 1; n <= 4; ++n) {
    const auto update = next({100.0 + 2 * n, 50, -1});
    if (!update) continue;
    merge(*update);
    sent_far = sent_far || has_far(*update);
  }
  EXPECT_TRUE(sent_far);
  expect_equal_near({140, 50, -1});
}

TEST_P(StockFeedTest, LimitsPatchesInFlight) {
  std::vector<StockUpdate> in_flight;
  for (int n = 0; n < 40; ++n) {
    cut_other({60, 50, -1 - 0.2 * n}, {60.5, 50, -1 - 0.2 * n});
    if (auto update = next({60, 50, 5}, false)) in_flight.push_back(std::move(*update));
  }
  ASSERT_EQ(in_flight.size(), std::size_t{wire::kStockFramesInFlight});
  EXPECT_EQ(in_flight[0].sequence, 1U);
  EXPECT_TRUE(in_flight[0].reset);
  EXPECT_FALSE(in_flight[1].reset);
  EXPECT_FALSE(feed_.ack(17)) << "was not sent";
  EXPECT_TRUE(feed_.ack(3));
  EXPECT_TRUE(feed_.ack(2)) << "an earlier ack is allowed";
  for (int n = 0; n < 10; ++n) {
    cut_other({60, 50, -10 - 0.2 * n}, {60.5, 50, -10 - 0.2 * n});
    if (auto update = next({60, 50, 5}, false)) in_flight.push_back(std::move(*update));
  }
  EXPECT_EQ(in_flight.size(), std::size_t{wire::kStockFramesInFlight} + 3);
}

TEST_P(StockFeedTest, LimitsBytesInFlight) {
  for (double y = 2; y < 100; y += 2) cut_other({0, y, -4}, {400, y + 1, -5});
  std::size_t bytes = 0;
  for (int n = 0; n < 10; ++n) {
    const auto update = next({40.0 + 30 * n, 50, -1}, false);
    if (!update) continue;
    for (const StockUpdate::Tile& tile : update->tiles) bytes += tile.columns.size();
  }
  EXPECT_GT(bytes, wire::kStockBytesInFlight);
  EXPECT_LT(bytes, wire::kStockBytesInFlight + 2 * StockFeed::kPatchBytes);
  EXPECT_TRUE(feed_.ack(2));
  EXPECT_TRUE(next({360, 50, -1}));
}

TEST_P(StockFeedTest, ResetStartsANewReplica) {
  cut_other({20, 20, -4}, {60, 50, -4});
  follow({30, 30, 2});
  cut_own({30, 30, -3}, {30, 30, -8});
  replica_ = block(GetParam());
  feed_.reset();
  const auto update = test::value_of(next({30, 30, -8}));
  EXPECT_TRUE(update.reset);
  EXPECT_EQ(update.agent_time_us, time_us_);
  merge(update);
  follow({30, 30, -8});
  expect_equal_near({30, 30, -8});
}

TEST_P(StockFeedTest, TilesWithReturnedStockAreResent) {
  feed_ = StockFeed(true);
  cut_other({20, 20, -4}, {60, 50, -4});
  follow({30, 30, 2});
  cut_own({32, 20, -3}, {34, 20, -8});
  const auto tiles = undo_near({30, 28, -4});
  cut_other({28, 28, -2}, {29, 28, -2});
  const auto update = test::value_of(next({34, 20, -8}));
  EXPECT_FALSE(update.reset);
  EXPECT_TRUE(update.returned);
  EXPECT_EQ(update.agent_time_us, time_us_);
  ASSERT_EQ(update.tiles.size(), tiles.size());
  for (const FieldTile& tile : tiles) {
    const auto sent = std::ranges::find(update.tiles, tile, &StockUpdate::Tile::at);
    ASSERT_NE(sent, update.tiles.end());
    EXPECT_FALSE(sent->columns.empty()) << "it has been cut again";
  }
  merge(update);
  const auto more = next({34, 20, -8});
  EXPECT_TRUE(!more || !more->returned);
  if (more) merge(*more);
  follow({34, 20, -8});
  expect_equal_near({34, 20, -8});
}

TEST_P(StockFeedTest, RestoredTilesAreUnknownUntilSent) {
  feed_ = StockFeed(true);
  cut_other({20, 20, -4}, {60, 50, -4});
  follow({30, 30, 2});
  const auto tiles = undo_near({30, 28, -4});
  const auto update = next({30, 30, 2});
  ASSERT_TRUE(update && update->returned);
  for (const StockUpdate::Tile& tile : update->tiles) EXPECT_TRUE(tile.columns.empty());
  merge(*update);
  const auto known = test::value_of(next({30, 30, 2}));
  EXPECT_FALSE(known.returned);
  for (const FieldTile& tile : tiles) {
    EXPECT_EQ(std::ranges::count(known.tiles, tile, &StockUpdate::Tile::at), 1);
  }
  EXPECT_FALSE(next({30, 30, 2}));
  expect_equal_near({30, 30, 2});
}

TEST_P(StockFeedTest, DistantReturnedTilesAreSentWhenTheToolArrives) {
  feed_ = StockFeed(true);
  cut_other({300, 20, -4}, {340, 50, -4});
  follow({310, 30, 2});
  for (double x = 310; x >= 30; x -= 10) follow({x, 30, 2});
  const auto tiles = undo_near({310, 28, -4});
  cut_other({309, 28, -2}, {311, 28, -2});
  const auto update = next({30, 30, 2});
  ASSERT_TRUE(update && update->returned);
  const auto sent = std::ranges::find(update->tiles, tiles.front(), &StockUpdate::Tile::at);
  ASSERT_NE(sent, update->tiles.end());
  EXPECT_TRUE(sent->columns.empty());
  merge(*update);
  follow({30, 30, 2});
  follow({310, 30, 2});
  expect_equal_near({310, 30, 2});
}

TEST_P(StockFeedTest, ReplicasRestartIfTheyCannotTakeTilesBack) {
  cut_other({20, 20, -4}, {60, 50, -4});
  follow({30, 30, 2});
  undo_near({30, 28, -4});
  auto update = next({30, 30, 2});
  ASSERT_TRUE(update);
  EXPECT_TRUE(update->reset && !update->returned);
  feed_ = StockFeed(true);
  follow({30, 30, 2});
  std::vector<FieldTile> many;
  for (std::int32_t n = 0; n <= std::int32_t(wire::kMaxStockTiles); ++n) {
    many.push_back({RayAxis::kZ, {n, 0}});
  }
  feed_.note_returned(many);
  update = next({30, 30, 2});
  ASSERT_TRUE(update);
  EXPECT_TRUE(update->reset && !update->returned);
}

TEST_P(StockFeedTest, SendsTheNearestTilesFirst) {
  for (double y = 2; y < 100; y += 2) cut_other({0, y, -4}, {400, y + 1, -5});
  const auto update = test::value_of(next({200, 50, -1}));
  ASSERT_FALSE(update.tiles.empty());
  const FieldTile first = update.tiles.front().at;
  if (first.axis == RayAxis::kZ) {
    EXPECT_EQ(first.tile, (TileIndex{12, 3}));
  }
  merge(update);
  follow({200, 50, -1});
  expect_equal_near({200, 50, -1});
}

TEST_P(StockFeedTest, ReplicaStaysCorrectOnALongSharedPath) {
  for (int n = 0; n < 300; ++n) {
    const double x = 20 + n, y = 50 + 30 * ((n % 20) / 20.0);
    cut_own(tip_ == Vec3{} ? Vec3{x, y, -2} : tip_, {x, y, -2.0 - n % 3});
    cut_other({x + 8, y - 10, -4}, {x + 8, y + 10, -1.0 - n % 5});
    if (const auto update = next({x, y, -2.0 - n % 3})) merge(*update);
  }
  follow(tip_);
  expect_equal_near(tip_);
}

TEST_P(StockFeedTest, StoresTilesWithoutNormals) {
  const auto stored_bytes = [](bool keep_normals) {
    auto server = *Sculpture::create({.stock = BoxStock{{0, 0, -20}, {100, 100, 0}},
                                      .rays = GetParam(),
                                      .pitch_mm = 0.5,
                                      .keep_normals = keep_normals});
    server.apply(DefineTool{1, *make_tool(BallShape{6, 40})}).value();
    for (double y = 10; y < 100; y += 20) {
      server.apply(MoveTool{1, {{0, y, -8}, kUp}, {{100, y, -8}, kUp}, 0, false}).value();
    }
    StockFeed feed(true, true);
    const ToolPose above{{50, 50, 5}, kUp};
    for (std::uint64_t us = 1; const auto update = feed.next(server, {*server.tool(1), above, us});
         ++us) {
      EXPECT_TRUE(feed.ack(update->sequence));
    }
    return feed.bytes();
  };
  EXPECT_GE(stored_bytes(false), 42 * sizeof(DexelTile)) << "seven by six tiles of 16 mm";
  EXPECT_EQ(stored_bytes(true), stored_bytes(false));
}

TEST(StockFeed, LimitsTheTilesOfARegion) {
  SculptureSettings settings{.stock = BoxStock{{0, 0, -20}, {400, 400, 0}}};
  settings.pitch_mm = 0.01;  // tiles of 0.32 mm
  settings.keep_normals = false;
  auto server = *Sculpture::create(settings);
  server.apply(DefineTool{1, *make_tool(BallShape{6, 40})}).value();
  server.apply(DefineTool{2, *make_tool(BallShape{60, 80})}).value();
  StockFeed feed;
  const ToolPose middle{{200, 200, -1}, kUp};
  EXPECT_LT(test::value_of(feed.next(server, {*server.tool(1), middle, 1000})).tiles.size(), 4097U);
  EXPECT_FALSE(feed.next(server, {*server.tool(2), middle, 21'000})) << "225 x 225 tiles";
  EXPECT_TRUE(feed.next(server, {*server.tool(1), {{150, 200, -1}, kUp}, 41'000}))
      << "the predicted path has too many tiles, the surroundings of the tool do not";
}

INSTANTIATE_TEST_SUITE_P(Rays, StockFeedTest, testing::Values(Rays::kDexel, Rays::kTriDexel));

}  // namespace
}  // namespace kerf::stock_feed_test
