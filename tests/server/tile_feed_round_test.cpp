// SPDX-License-Identifier: Apache-2.0
#include "server/feed/tile_feed.h"
#include "tests/support/carvings.h"
#include "tests/support/test.h"

namespace kerf::tile_feed_round_test {
namespace {

/// Takes and acknowledges all frames for a viewer. Returns their number.
int drain(TileFeed& feed, ViewerId viewer) {
  int frames = 0;
  for (; auto frame = feed.next_frame(viewer); ++frames) {
    EXPECT_TRUE(feed.ack(viewer, frame->sequence));
  }
  return frames;
}

TEST(TileFeedRound, ViewersShareFramesWhileTheBlockChanges) {
  const BoxStock block{{0, 0, 0}, {40, 30, 8}};
  Sculpture sculpture = test::make_sculpture(block, 0.25);
  test::RandomCarver carver(sculpture, block.min_mm, block.max_mm, 5);
  TileFeed feed(sculpture.solid(), 0);
  std::uint64_t motions = 0;
  const auto cut = [&] {
    const auto changed = carver.cut();
    feed.note_change(sculpture.solid(), changed, ++motions);
  };
  const ViewerId first = feed.add_viewer(), second = feed.add_viewer();
  const int frames = drain(feed, first);
  EXPECT_EQ(drain(feed, second), frames);
  cut();
  {
    const TileFeed::Round round(feed);
    const auto frame = test::value_of(feed.next_frame(first));
    const auto meshed = feed.stats().tiles_meshed;
    cut();
    const auto same = test::value_of(feed.next_frame(second));
    EXPECT_EQ(same.glb, frame.glb);
    EXPECT_EQ(feed.stats().tiles_meshed, meshed);
    EXPECT_TRUE(feed.ack(first, frame.sequence) && feed.ack(second, same.sequence));
    EXPECT_FALSE(feed.next_frame(first));
  }
  EXPECT_GT(drain(feed, first), 0);
  EXPECT_GT(drain(feed, second), 0);
  EXPECT_EQ(feed.viewer_state(second)->revision, 2U);
}

}  // namespace
}  // namespace kerf::tile_feed_round_test
