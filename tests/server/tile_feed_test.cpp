#include "server/feed/tile_feed.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/support/carvings.h"
#include "tests/support/glb_reader.h"
#include "tests/support/mesh_check.h"

namespace kerf {
namespace {

const BoxStock kBlock{{0, 0, 0}, {40, 30, 8}};

/// What a viewer does: keeps the newest version of every tile, and complains if one comes twice or
/// goes back.
class Screen {
 public:
  void apply(const FeedFrame& frame) {
    bytes_ += frame.glb->size();
    for (auto& [index, tile] : test::read_mesh_glb(*frame.glb).tiles) {
      EXPECT_GT(tile.version, tiles_[index].version);
      tiles_[index] = std::move(tile);
    }
  }
  /// Takes and acknowledges everything there is; returns the number of frames.
  std::size_t drain(TileFeed& feed, ViewerId viewer) {
    std::size_t frames = 0;
    while (auto frame = feed.next_frame(viewer)) {
      ++frames;
      apply(*frame);
      EXPECT_TRUE(feed.ack(viewer, frame->sequence));
    }
    return frames;
  }
  void expect_shows(const SolidSnapshot& snapshot) const {
    const MeshQuantization quantization = mesh_quantization(snapshot.grid());
    for (const TileMesh& mesh : test::mesh_all(snapshot)) {
      const EncodedTile plain = encode_tile(mesh, quantization, 1);
      const EncodedTile* pointer = &plain;
      const auto expected = test::read_mesh_glb(write_mesh_glb({&pointer, 1}, quantization, 0, 0));
      ASSERT_EQ(test::triangles_of(tiles_.at(mesh.tile)),
                test::triangles_of(expected.tiles.at(mesh.tile)));
    }
  }
  std::size_t tiles() const { return tiles_.size(); }
  std::size_t bytes() const { return bytes_; }

 private:
  std::map<TileIndex, test::DecodedTile> tiles_;
  std::size_t bytes_ = 0;
};

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

TEST_F(TileFeedTest, FirstSnapshotComesInPartsAndMarksItsEnd) {
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
  screen.expect_shows(sculpture_.solid());
}

TEST_F(TileFeedTest, ViewersConvergeToTheNewestStateHoweverSlowTheyAre) {
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
  fast_screen.expect_shows(snapshot);
  slow_screen.expect_shows(snapshot);
  late_screen.expect_shows(snapshot);
  for (const ViewerId viewer : {fast, slow, late}) {
    EXPECT_TRUE(feed.viewer_state(viewer)->applied);
    EXPECT_EQ(feed.viewer_state(viewer)->revision, 30U);
  }
  // The slow viewer skipped versions: that is what latest-wins saves.
  EXPECT_LT(slow_screen.bytes(), fast_screen.bytes());
}

TEST_F(TileFeedTest, NoCreditNoFrame) {
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

TEST_F(TileFeedTest, AcksThatCannotBeAreRefused) {
  TileFeed feed(sculpture_.solid(), 0);
  const ViewerId viewer = feed.add_viewer();
  EXPECT_FALSE(feed.ack(viewer, 1));
  ASSERT_TRUE(feed.next_frame(viewer));
  EXPECT_TRUE(feed.ack(viewer, 1));
  EXPECT_TRUE(feed.ack(viewer, 1));  // a repetition changes nothing
  EXPECT_TRUE(feed.ack(viewer, 0));
  EXPECT_FALSE(feed.ack(viewer, 2));
  EXPECT_FALSE(feed.ack(viewer + 1, 1));
  feed.remove_viewer(viewer);
  EXPECT_FALSE(feed.next_frame(viewer));
  EXPECT_FALSE(feed.viewer_state(viewer));
  EXPECT_EQ(feed.viewers(), 0U);
}

TEST_F(TileFeedTest, MeshesAndComposesOnceForAllViewers) {
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
  // Neighbours that only might have changed are meshed, and not sent.
  EXPECT_GT(second.tiles_unchanged, 0U);
}

TEST_F(TileFeedTest, NobodyLookingMeansNothingMeshed) {
  TileFeed feed(sculpture_.solid(), 0);
  for (int n = 0; n < 10; ++n) cut(feed);
  EXPECT_EQ(feed.stats().tiles_meshed, 0U);
}

TEST_F(TileFeedTest, KnowsWhenAViewerHasEverything) {
  TileFeed feed(sculpture_.solid(), 41);
  const ViewerId viewer = feed.add_viewer();
  EXPECT_FALSE(feed.viewer_state(viewer)->sent);
  const auto frame = feed.next_frame(viewer);
  ASSERT_TRUE(frame);
  EXPECT_EQ(test::read_mesh_glb(*frame->glb).to, 41U);
  EXPECT_TRUE(feed.viewer_state(viewer)->sent);
  EXPECT_FALSE(feed.viewer_state(viewer)->applied);
  ASSERT_TRUE(feed.ack(viewer, frame->sequence));
  EXPECT_TRUE(feed.viewer_state(viewer)->applied);
  EXPECT_EQ(feed.viewer_state(viewer)->revision, 41U);
  revision_ = 41;
  cut(feed, 5);
  EXPECT_FALSE(feed.viewer_state(viewer)->sent);
  EXPECT_EQ(feed.viewer_state(viewer)->revision, 46U);
  EXPECT_EQ(feed.newest().second, 46U);
  EXPECT_EQ(feed.newest().first.hash(), sculpture_.state_hash());
  // A motion through the air changes the revision and nothing to see.
  Screen screen;
  screen.apply(*frame);
  screen.drain(feed, viewer);
  feed.note_change(sculpture_.solid(), {}, 47);
  EXPECT_TRUE(feed.viewer_state(viewer)->applied);
  EXPECT_EQ(feed.viewer_state(viewer)->revision, 47U);
  EXPECT_FALSE(feed.next_frame(viewer));
}

TEST_F(TileFeedTest, SessionAndViewerLanesRunSideBySide) {
  TileFeed feed(sculpture_.solid(), 0, {.frame_bytes_max = 20000});
  std::atomic<bool> stop = false;
  std::array<Screen, 3> screens;
  std::array<ViewerId, 3> viewers{feed.add_viewer(), feed.add_viewer(), feed.add_viewer()};
  std::vector<std::thread> lanes;
  for (std::size_t n = 0; n < screens.size(); ++n) {
    lanes.emplace_back([&, n] {
      while (!stop) screens[n].drain(feed, viewers[n]);
      screens[n].drain(feed, viewers[n]);
    });
  }
  for (int n = 0; n < 40; ++n) cut(feed);
  stop = true;
  for (std::thread& lane : lanes) lane.join();
  for (const Screen& screen : screens) screen.expect_shows(sculpture_.solid());
}

}  // namespace
}  // namespace kerf
