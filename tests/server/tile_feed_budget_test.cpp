// SPDX-License-Identifier: Apache-2.0
#include "server/feed/tile_feed.h"
#include "tests/server/feed_screen.h"
#include "tests/support/carvings.h"
#include "tests/support/test.h"

namespace kerf::tile_feed_budget_test {
namespace {

using std::chrono::milliseconds;
using test::Screen;

const BoxStock kBlock{{0, 0, 0}, {40, 30, 8}};
constexpr milliseconds kTick{33};
/// Maximum size of a tile of these blocks in a frame of its own.
constexpr double kTileBytesMax = 25'000;

double seconds(ByteBudget::Time::duration time) {
  return std::chrono::duration<double>(time).count();
}

/// A viewer with a budget, and the times and sizes of its frames.
class Limited {
 public:
  Limited(TileFeed& feed, std::uint32_t budget)
      : feed_(feed), id(feed.add_viewer(std::nullopt, TileNodes::kSingle, budget)) {}
  void tick(ByteBudget::Time now) {
    while (auto frame = feed_.next_frame(id, now)) {
      sent.emplace_back(now, double(frame->glb->size()));
      screen.apply(*frame);
      EXPECT_TRUE(feed_.ack(id, frame->sequence));
    }
  }
  bool has_all() const { return feed_.viewer_state(id)->sent; }
  bool has_coarse() const { return screen.levels().contains(1); }

 private:
  TileFeed& feed_;

 public:
  const ViewerId id;
  Screen screen;
  std::vector<std::pair<ByteBudget::Time, double>> sent;
};

class TileFeedBudgetTest : public ::testing::TestWithParam<unsigned> {
 protected:
  TileFeedBudgetTest()
      : sculpture_(test::make_sculpture(kBlock, 0.25)),
        carver_(sculpture_, kBlock.min_mm, kBlock.max_mm, GetParam()),
        feed_(sculpture_.solid(), 0) {}

  void cut() { feed_.note_change(sculpture_.solid(), carver_.cut(), ++revision_); }
  bool chance(double share) { return carver_.uniform(0, 1) < share; }
  /// Ticks until the viewer has everything. Returns the elapsed time, s.
  double settle(Limited& viewer) {
    const auto start = now_;
    while (!viewer.has_all() && seconds(now_ - start) < 120) viewer.tick(now_ += kTick);
    return seconds(now_ - start);
  }

  Sculpture sculpture_;
  test::RandomCarver carver_;
  TileFeed feed_;
  std::uint64_t revision_ = 0;
  ByteBudget::Time now_{std::chrono::seconds(1000)};
};

TEST_P(TileFeedBudgetTest, NoWindowHasMoreBytesThanTheBudget) {
  constexpr double kBudget = 150'000;
  Limited viewer(feed_, std::uint32_t(kBudget));
  bool cuts = true;
  for (int n = 0; n < 400; ++n) {
    if (chance(0.03)) cuts = !cuts;
    if (cuts && chance(0.2)) cut();
    if (chance(0.01)) feed_.look(viewer.id, {{20, 15, carver_.uniform(9, 400)}, 0.001});
    viewer.tick(now_ += kTick);
  }
  const auto& sent = viewer.sent;
  ASSERT_GT(sent.size(), 50U);
  const double burst = kBudget * seconds(ByteBudget::kBurst + ByteBudget::kStep) + kTileBytesMax;
  for (std::size_t first = 0; first < sent.size(); ++first) {
    double bytes = 0;
    for (std::size_t last = first; last < sent.size(); ++last) {
      bytes += sent[last].second;
      ASSERT_LE(bytes, kBudget * seconds(sent[last].first - sent[first].first) + burst);
    }
  }
}

TEST_P(TileFeedBudgetTest, TheViewerGetsEveryTileAtItsLevelOnceTheChangesStop) {
  for (const std::uint32_t budget : {25'000U, 200'000U}) {
    Limited viewer(feed_, budget);
    bool was_coarse = false;
    for (int n = 0; n < 15; ++n) {
      cut();
      viewer.tick(now_ += kTick);
      EXPECT_FALSE(viewer.has_all() && viewer.has_coarse());
      was_coarse = was_coarse || viewer.has_coarse();
    }
    EXPECT_TRUE(was_coarse);
    const double tiles = double(feed_.newest().first.grid().tiles_x()) *
                         double(feed_.newest().first.grid().tiles_y());
    EXPECT_LT(settle(viewer), 2 * tiles * kTileBytesMax / budget + 1);
    EXPECT_TRUE(feed_.viewer_state(viewer.id)->applied);
    EXPECT_FALSE(feed_.viewer_state(viewer.id)->waits_for_budget);
    EXPECT_FALSE(viewer.has_coarse());
    EXPECT_TRUE(viewer.screen.is_closed());
    viewer.screen.expect_equal(sculpture_.solid());
    feed_.remove_viewer(viewer.id);
  }
}

TEST_P(TileFeedBudgetTest, ChangingTileIsNeverStale) {
  Limited viewer(feed_, 200'000);
  settle(viewer);
  const ViewerId reference = feed_.add_viewer();
  Screen exact;
  exact.drain(feed_, reference);
  // When the oldest version that the viewer lacks appeared.
  std::map<TileIndex, ByteBudget::Time> lacks;
  double oldest_s = 0;
  for (int n = 0; n < 120; ++n) {
    now_ += kTick;
    if (n % 4 == 0) cut();
    exact.drain(feed_, reference);
    viewer.tick(now_);
    for (const auto& [index, tile] : exact.all()) {
      if (viewer.screen.all().at(index).version == tile.version) {
        lacks.erase(index);
      } else {
        oldest_s = std::max(oldest_s, seconds(now_ - lacks.try_emplace(index, now_).first->second));
      }
    }
  }
  EXPECT_GT(viewer.screen.levels()[1], 0);
  // Sending all tiles of the block takes this long at level 1, and three times as long exactly.
  EXPECT_LT(oldest_s, 1.0);
}

TEST_P(TileFeedBudgetTest, ChangesAreSentBeforeRefinements) {
  Limited viewer(feed_, 200'000);
  settle(viewer);
  for (int n = 0; n < 8; ++n) cut();
  // All tiles are coarse, and some have reached their level since.
  const auto coarse = [&] { return viewer.screen.levels()[1]; };
  int most = 0;
  for (int n = 0; n < 300 && coarse() >= most; ++n) {
    most = std::max(most, coarse());
    viewer.tick(now_ += kTick);
  }
  ASSERT_GT(coarse(), 0);
  const std::size_t frames = viewer.sent.size();
  cut();
  viewer.tick(now_);
  EXPECT_GT(viewer.sent.size(), frames);
}

TEST_P(TileFeedBudgetTest, ACoarseTileHasNoCracksToExactOnes) {
  Limited viewer(feed_, 100'000);
  settle(viewer);
  const ViewerId reference = feed_.add_viewer();
  Screen exact;
  int mixed = 0;
  for (int n = 0; n < 90; ++n) {
    now_ += kTick;
    if (n % 30 == 0) cut();
    exact.drain(feed_, reference);
    viewer.tick(now_);
    const bool is_new = std::ranges::all_of(exact.all(), [&](const auto& tile) {
      return viewer.screen.all().at(tile.first).version == tile.second.version;
    });
    if (!is_new || !viewer.has_coarse()) continue;
    ++mixed;
    EXPECT_TRUE(viewer.screen.is_closed()) << n;
  }
  EXPECT_GT(mixed, 10);
}

TEST_P(TileFeedBudgetTest, LimitedViewerDoesNotAffectUnlimitedOnes) {
  TileFeed other(sculpture_.solid(), 0);
  const ViewerId alone = other.add_viewer();
  const ViewerId beside = feed_.add_viewer();
  Limited limited(feed_, 50'000);
  for (int n = 0; n < 15; ++n) {
    const auto changed = carver_.cut();
    for (TileFeed* feed : {&feed_, &other}) {
      feed->note_change(sculpture_.solid(), changed, std::uint64_t(n));
    }
    for (;;) {
      const auto frame = feed_.next_frame(beside);
      const auto expected = other.next_frame(alone);
      ASSERT_EQ(frame.has_value(), expected.has_value());
      if (!frame) break;
      ASSERT_EQ(frame->flags, expected->flags);
      ASSERT_EQ(*frame->glb, *expected->glb);
      feed_.ack(beside, frame->sequence);
      other.ack(alone, expected->sequence);
    }
    limited.tick(now_ += kTick);
  }
  EXPECT_TRUE(limited.has_coarse());
}

TEST_P(TileFeedBudgetTest, ViewersOfTheSameBudgetShareTheirFrames) {
  std::vector<Limited> viewers;
  viewers.reserve(3);
  for (int n = 0; n < 2; ++n) viewers.emplace_back(feed_, 100'000);
  const auto run = [&](int ticks, bool cuts) {
    for (int n = 0; n < ticks; ++n) {
      now_ += kTick;
      if (cuts) cut();
      for (Limited& viewer : viewers) viewer.tick(now_);
    }
  };
  run(15, true);
  EXPECT_EQ(feed_.stats().frames_shared, feed_.stats().frames_composed);
  viewers.emplace_back(feed_, 100'000);
  run(300, false);
  const auto before = feed_.stats();
  run(15, true);
  const auto after = feed_.stats();
  // The third viewer has caught up, and its budget has recovered.
  EXPECT_EQ(after.frames_shared - before.frames_shared,
            2 * (after.frames_composed - before.frames_composed));
}

TEST_P(TileFeedBudgetTest, BudgetMayBeChangedAndRemoved) {
  const ViewerId viewer = feed_.add_viewer();
  Screen screen;
  screen.drain(feed_, viewer);
  feed_.set_budget(viewer, 25'000);
  feed_.set_budget(viewer + 7, 25'000);
  for (int n = 0; n < 10; ++n) cut();
  EXPECT_FALSE(feed_.next_frame(viewer, now_)) << "the bucket is empty at first";
  EXPECT_TRUE(feed_.viewer_state(viewer)->waits_for_budget);
  const auto frame = test::value_of(feed_.next_frame(viewer, now_ += ByteBudget::kStep));
  screen.apply(frame);
  feed_.ack(viewer, frame.sequence);
  EXPECT_FALSE(feed_.next_frame(viewer, now_));
  feed_.set_budget(viewer, 0);
  EXPECT_FALSE(feed_.viewer_state(viewer)->waits_for_budget);
  screen.drain(feed_, viewer);
  EXPECT_TRUE(feed_.viewer_state(viewer)->applied);
  screen.expect_equal(sculpture_.solid());
}

INSTANTIATE_TEST_SUITE_P(RandomCuts, TileFeedBudgetTest, ::testing::Values(1U, 2U));

}  // namespace
}  // namespace kerf::tile_feed_budget_test
