// SPDX-License-Identifier: Apache-2.0
#include "server/feed/tile_feed.h"

#include "tests/server/feed_screen.h"
#include "tests/support/carvings.h"
#include "tests/support/test.h"

namespace kerf::tile_feed_test {
namespace {

using test::Screen;

const BoxStock kBlock{{0, 0, 0}, {40, 30, 8}};

class TileFeedTest : public ::testing::Test {
 protected:
  TileFeedTest()
      : sculpture_(test::make_sculpture(kBlock, 0.25)),
        carver_(sculpture_, kBlock.min_mm, kBlock.max_mm, 5) {}

  void cut(TileFeed& feed, int moves = 1) {
    std::vector<TileIndex> changed;
    for (int n = 0; n < moves; ++n) {
      const auto tiles = carver_.cut();
      changed.insert(changed.end(), tiles.begin(), tiles.end());
    }
    revision_ += std::uint64_t(moves);
    feed.note_change(sculpture_.solid(), changed, revision_);
  }

  Sculpture sculpture_;
  test::RandomCarver carver_;
  std::uint64_t revision_ = 0;
};

TEST_F(TileFeedTest, FirstSnapshotIsSentInPartsWithAnEndFlag) {
  TileFeed feed(sculpture_.solid(), 0, {.frame_bytes_max = 4096});
  const ViewerId viewer = feed.add_viewer();
  Screen screen;
  std::vector<std::uint8_t> flags;
  while (auto frame = feed.next_frame(viewer)) {
    flags.push_back(frame->flags);
    screen.apply(*frame);
    EXPECT_LT(frame->glb->size(), 3 * 4096U);
    ASSERT_TRUE(feed.ack(viewer, frame->sequence));
  }
  ASSERT_GT(flags.size(), 3U);
  for (std::size_t n = 0; n + 1 < flags.size(); ++n) EXPECT_EQ(flags[n], kFirstSnapshot);
  EXPECT_EQ(flags.back(), kFirstSnapshot | kFirstSnapshotEnd);
  EXPECT_EQ(screen.tiles(), std::size_t(sculpture_.grid().tiles_x() * sculpture_.grid().tiles_y()));
  screen.expect_equal(sculpture_.solid());
}

TEST(TileFeedFirstSnapshot, UntouchedTilesShareTheirMeshes) {
  Sculpture sculpture = test::make_sculpture(BoxStock{{0, 0, 0}, {400, 400, 8}}, 0.5);
  TileFeed feed(sculpture.solid(), 0);
  const ViewerId viewer = feed.add_viewer();
  Screen screen;
  std::uint64_t meshed = 0;
  while (auto frame = feed.next_frame(viewer)) {
    // A frame ends before other viewers have waited long for the tiles meshed for it.
    EXPECT_LE(feed.stats().tiles_meshed - meshed, 200U);
    meshed = feed.stats().tiles_meshed;
    screen.apply(*frame);
    ASSERT_TRUE(feed.ack(viewer, frame->sequence));
  }
  EXPECT_EQ(screen.tiles(), 625U);
  EXPECT_LT(screen.bytes(), 300 * screen.tiles());
  EXPECT_TRUE(screen.is_closed());
  screen.expect_equal(sculpture.solid());
}

TEST_F(TileFeedTest, AFrameOfUnchangedTilesDoesNotEndBeforeTheChangedOnes) {
  TileFeed feed(sculpture_.solid(), 0, {.frame_bytes_max = 1});
  const ViewerId viewer = feed.add_viewer();
  Screen screen;
  screen.drain(feed, viewer);
  for (int n = 0; n < 8; ++n) {
    cut(feed);
    screen.drain(feed, viewer);
    EXPECT_TRUE(feed.viewer_state(viewer)->applied);
    screen.expect_equal(sculpture_.solid());
  }
  EXPECT_GT(feed.stats().tiles_unchanged, 0U);
}

TEST_F(TileFeedTest, ViewerWithAnInitialLookGetsEachTileOnce) {
  TileFeed feed(sculpture_.solid(), 0);
  cut(feed, 6);
  const ViewerLook look{{20, 15, 3000}, 0.001};
  const ViewerId viewer = feed.add_viewer(look);
  Screen screen;
  screen.drain(feed, viewer);
  const int tiles = int(screen.tiles());
  EXPECT_EQ(screen.levels(), (std::map<int, int>{{kDetailLevelMax, tiles}}));
  feed.look(viewer, look);
  EXPECT_FALSE(feed.next_frame(viewer));
  EXPECT_EQ(screen.same_version(), 0U);
  EXPECT_TRUE(screen.is_closed());
}

TEST_F(TileFeedTest, SlowViewersConvergeToTheNewestState) {
  TileFeed feed(sculpture_.solid(), 0, {.frame_bytes_max = 30000});
  const ViewerId fast = feed.add_viewer();
  const ViewerId slow = feed.add_viewer();
  Screen fast_screen, slow_screen;
  ViewerId late = 0;
  Screen late_screen;
  for (int n = 0; n < 30; ++n) {
    cut(feed);
    fast_screen.drain(feed, fast);
    if (n % 7 == 0) {
      if (auto frame = feed.next_frame(slow)) {
        slow_screen.apply(*frame);
        feed.ack(slow, frame->sequence);
      }
    }
    if (n == 20) late = feed.add_viewer();
    if (n > 20) {
      if (auto frame = feed.next_frame(late)) {
        late_screen.apply(*frame);
        feed.ack(late, frame->sequence);
      }
    }
  }
  fast_screen.drain(feed, fast);
  slow_screen.drain(feed, slow);
  late_screen.drain(feed, late);
  const SolidSnapshot snapshot = sculpture_.solid();
  EXPECT_EQ(fast_screen.same_version(), 0U);
  EXPECT_EQ(slow_screen.same_version(), 0U);
  fast_screen.expect_equal(snapshot);
  slow_screen.expect_equal(snapshot);
  late_screen.expect_equal(snapshot);
  for (const ViewerId viewer : {fast, slow, late}) {
    EXPECT_TRUE(feed.viewer_state(viewer)->applied);
    EXPECT_EQ(feed.viewer_state(viewer)->revision, 30U);
  }
  // The slow viewer skipped versions.
  EXPECT_LT(slow_screen.bytes(), fast_screen.bytes());
}

TEST(TileFeedDeltas, BringEveryTileWhoseMeshChangedWithEachMotion) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    SculptureSettings settings{.stock = BoxStock{{0, 0, 0}, {33, 27, 9}}};
    settings.pitch_mm = 0.5;  // the tools' features are of that size
    settings.rays = rays;
    Sculpture sculpture = std::move(Sculpture::create(settings).value());
    test::RandomCarver carver(sculpture, {0, 0, 0}, {33, 27, 9}, 3);
    TileFeed feed(sculpture.solid(), 0);
    const ViewerId viewer = feed.add_viewer();
    Screen screen;
    screen.drain(feed, viewer);
    for (std::uint64_t n = 1; n <= 20; ++n) {
      SCOPED_TRACE("motion " + std::to_string(n) + " " + to_string(rays));
      const auto changed = carver.cut();
      feed.note_change(sculpture.solid(), changed, n);
      screen.drain(feed, viewer);
      screen.expect_equal(sculpture.solid());
      ASSERT_FALSE(HasFatalFailure());
      EXPECT_TRUE(screen.is_closed());
    }
    EXPECT_GT(feed.stats().tiles_unchanged, 0U);
    EXPECT_EQ(screen.same_version(), 0U);
  }
}

TEST_F(TileFeedTest, LimitsFramesInFlight) {
  TileFeed feed(sculpture_.solid(), 0, {.frame_bytes_max = 1, .frames_in_flight_max = 2});
  const ViewerId viewer = feed.add_viewer();
  const auto first = feed.next_frame(viewer);
  const auto second = feed.next_frame(viewer);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->sequence, 1U);
  EXPECT_EQ(second->sequence, 2U);
  EXPECT_FALSE(feed.next_frame(viewer));
  EXPECT_EQ(feed.viewer_state(viewer)->frames_in_flight, 2U);
  EXPECT_TRUE(feed.ack(viewer, 1));
  EXPECT_TRUE(feed.next_frame(viewer));
  EXPECT_FALSE(feed.next_frame(viewer));
}

TEST_F(TileFeedTest, InvalidAcksAreRejected) {
  TileFeed feed(sculpture_.solid(), 0);
  const ViewerId viewer = feed.add_viewer();
  EXPECT_FALSE(feed.ack(viewer, 1));
  ASSERT_TRUE(feed.next_frame(viewer));
  EXPECT_TRUE(feed.ack(viewer, 1));
  EXPECT_TRUE(feed.ack(viewer, 1));  // a repeated ack has no effect
  EXPECT_TRUE(feed.ack(viewer, 0));
  EXPECT_FALSE(feed.ack(viewer, 2));
  EXPECT_FALSE(feed.ack(viewer + 1, 1));
  feed.remove_viewer(viewer);
  EXPECT_FALSE(feed.next_frame(viewer));
  EXPECT_FALSE(feed.viewer_state(viewer));
  EXPECT_EQ(feed.viewers(), 0U);
}

TEST_F(TileFeedTest, ViewersShareMeshesAndFrames) {
  TileFeed feed(sculpture_.solid(), 0);
  std::vector<ViewerId> viewers;
  for (int n = 0; n < 20; ++n) viewers.push_back(feed.add_viewer());
  std::vector<Screen> screens(viewers.size());
  const auto round = [&] {
    for (std::size_t n = 0; n < viewers.size(); ++n) screens[n].drain(feed, viewers[n]);
  };
  round();
  const auto first = feed.stats();
  EXPECT_EQ(first.tiles_meshed, screens[0].tiles());
  EXPECT_EQ(first.frames_shared, 19 * first.frames_composed);
  cut(feed, 3);
  round();
  const auto second = feed.stats();
  EXPECT_EQ(second.frames_shared, 19 * second.frames_composed);
  EXPECT_GT(second.tiles_meshed, first.tiles_meshed);
  // Neighbors that might have changed are meshed but not sent.
  EXPECT_GT(second.tiles_unchanged, 0U);
}

TEST_F(TileFeedTest, MeshesNothingWithoutViewers) {
  TileFeed feed(sculpture_.solid(), 0);
  for (int n = 0; n < 10; ++n) cut(feed);
  EXPECT_EQ(feed.stats().tiles_meshed, 0U);
}

TEST_F(TileFeedTest, ReportsWhenAViewerIsUpToDate) {
  TileFeed feed(sculpture_.solid(), 41);
  const ViewerId viewer = feed.add_viewer();
  EXPECT_FALSE(feed.viewer_state(viewer)->sent);
  const auto frame = test::value_of(feed.next_frame(viewer));
  EXPECT_EQ(test::read_mesh_glb(*frame.glb).to, 41U);
  EXPECT_TRUE(feed.viewer_state(viewer)->sent);
  EXPECT_FALSE(feed.viewer_state(viewer)->applied);
  ASSERT_TRUE(feed.ack(viewer, frame.sequence));
  EXPECT_TRUE(feed.viewer_state(viewer)->applied);
  EXPECT_EQ(feed.viewer_state(viewer)->revision, 41U);
  revision_ = 41;
  cut(feed, 5);
  EXPECT_FALSE(feed.viewer_state(viewer)->sent);
  EXPECT_EQ(feed.viewer_state(viewer)->revision, 46U);
  EXPECT_EQ(feed.newest().second, 46U);
  EXPECT_EQ(feed.newest().first.hash(), sculpture_.state_hash());
  // A motion through the air changes only the revision.
  Screen screen;
  screen.apply(frame);
  screen.drain(feed, viewer);
  feed.note_change(sculpture_.solid(), {}, 47);
  EXPECT_TRUE(feed.viewer_state(viewer)->applied);
  EXPECT_EQ(feed.viewer_state(viewer)->revision, 47U);
  EXPECT_FALSE(feed.next_frame(viewer));
}

TEST_F(TileFeedTest, DistantViewersReceiveCoarserTilesUntilTheyApproach) {
  TileFeed feed(sculpture_.solid(), 0);
  cut(feed, 6);
  const ViewerId near = feed.add_viewer();
  const ViewerId far = feed.add_viewer();
  feed.look(far, {{20, 15, 3000}, 0.001});
  Screen near_screen, far_screen;
  near_screen.drain(feed, near);
  far_screen.drain(feed, far);
  const int tiles = int(far_screen.tiles());
  EXPECT_EQ(far_screen.levels(), (std::map<int, int>{{kDetailLevelMax, tiles}}));
  EXPECT_EQ(near_screen.levels(), (std::map<int, int>{{0, tiles}}));
  EXPECT_LT(5 * far_screen.triangles(), near_screen.triangles());
  EXPECT_TRUE(near_screen.is_closed());
  EXPECT_TRUE(far_screen.is_closed());
  feed.look(far, {{20, 15, 3000}, 0});
  EXPECT_FALSE(feed.viewer_state(far)->sent);
  far_screen.drain(feed, far);
  EXPECT_TRUE(feed.viewer_state(far)->applied);
  far_screen.expect_equal(sculpture_.solid());
  EXPECT_EQ(far_screen.same_version(), std::size_t(tiles));
  feed.look(far, {{20, 15, 4000}, 0});  // no level changes
  EXPECT_FALSE(feed.next_frame(far));
  feed.look(far + 7, {{0, 0, 0}, 1});
}

TEST_F(TileFeedTest, MixedLevelsStayClosedWhileTheBlockIsCarved) {
  TileFeed feed(sculpture_.solid(), 0, {.frame_bytes_max = 20000});
  const std::array<ViewerId, 2> viewers{feed.add_viewer(), feed.add_viewer()};
  std::array<Screen, 2> screens;
  bool mixed = false;
  for (int n = 0; n < 12; ++n) {
    cut(feed, 2);
    // Close above a different corner each time.
    const Vec3 eye{n % 2 == 0 ? 0.0 : 40.0, n % 4 < 2 ? 0.0 : 30.0, 9};
    for (std::size_t v = 0; v < viewers.size(); ++v) {
      feed.look(viewers[v], {eye, 0.02});
      screens[v].drain(feed, viewers[v]);
      EXPECT_TRUE(screens[v].is_closed()) << n;
    }
    mixed = mixed || screens[0].levels().size() > 2;
  }
  EXPECT_TRUE(mixed);
  EXPECT_EQ(screens[0].levels(), screens[1].levels());
  // Viewers with equal viewpoints share all frames.
  EXPECT_EQ(feed.stats().frames_shared, feed.stats().frames_composed);
  for (const ViewerId viewer : viewers) feed.look(viewer, {{}, 0});
  screens[0].drain(feed, viewers[0]);
  screens[0].expect_equal(sculpture_.solid());
}

TEST_F(TileFeedTest, SessionAndViewerThreadsRunConcurrently) {
  TileFeed feed(sculpture_.solid(), 0, {.frame_bytes_max = 20000});
  std::atomic<bool> stop = false;
  std::array<Screen, 3> screens;
  std::array<ViewerId, 3> viewers{feed.add_viewer(), feed.add_viewer(), feed.add_viewer()};
  std::vector<std::thread> threads;
  for (std::size_t n = 0; n < screens.size(); ++n) {
    threads.emplace_back([&, n] {
      while (!stop) screens[n].drain(feed, viewers[n]);
      screens[n].drain(feed, viewers[n]);
    });
  }
  for (int n = 0; n < 40; ++n) cut(feed);
  stop = true;
  for (std::thread& thread : threads) thread.join();
  for (const Screen& screen : screens) screen.expect_equal(sculpture_.solid());
}

}  // namespace
}  // namespace kerf::tile_feed_test
