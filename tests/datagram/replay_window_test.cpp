// SPDX-License-Identifier: Apache-2.0
#include "server/datagram/replay_window.h"

#include "tests/support/test.h"

namespace kerf::datagram::replay_window_test {
namespace {

bool pass(ReplayWindow& window, std::uint64_t counter) {
  if (!window.admits(counter)) return false;
  window.take(counter);
  return true;
}

TEST(ReplayWindow, AdmitsEachCounterOnce) {
  ReplayWindow window;
  EXPECT_FALSE(pass(window, 0)) << "counters start at 1";
  for (const std::uint64_t counter : {1U, 2U, 5U, 4U, 3U}) EXPECT_TRUE(pass(window, counter));
  for (const std::uint64_t counter : {1U, 2U, 3U, 4U, 5U}) EXPECT_FALSE(pass(window, counter));
  EXPECT_TRUE(pass(window, 6));
}

TEST(ReplayWindow, TakeReportsTheNewestCounter) {
  ReplayWindow window;
  EXPECT_TRUE(window.take(10));
  EXPECT_FALSE(window.take(9));
  EXPECT_TRUE(window.take(11));
  EXPECT_EQ(window.newest(), 11U);
}

TEST(ReplayWindow, RejectsCountersFarBehindTheNewest) {
  ReplayWindow window;
  EXPECT_TRUE(pass(window, 1'000'000));
  EXPECT_FALSE(window.admits(1'000'000 - ReplayWindow::kCounters));
  EXPECT_TRUE(pass(window, 1'000'001 - ReplayWindow::kCounters));
  EXPECT_TRUE(pass(window, 1'000'000 + 10 * ReplayWindow::kCounters));
  EXPECT_FALSE(window.admits(1'000'000));
  EXPECT_TRUE(pass(window, ~std::uint64_t{0}));
  EXPECT_FALSE(pass(window, ~std::uint64_t{0}));
}

TEST(ReplayWindow, MatchesASetOfCountersInRandomOrder) {
  std::mt19937_64 random(7);
  ReplayWindow window;
  std::set<std::uint64_t> seen;
  std::uint64_t newest = 0;
  for (int i = 0; i < 100'000; ++i) {
    const std::uint64_t behind = random() % 400;
    const std::uint64_t counter = newest + random() % 3 - std::min(newest, behind);
    const bool expected = counter > 0 && !seen.contains(counter) &&
                          (counter > newest || newest - counter < ReplayWindow::kCounters);
    ASSERT_EQ(pass(window, counter), expected) << counter << " after " << newest;
    if (expected) seen.insert(counter);
    newest = std::max(newest, expected ? counter : 0);
  }
}

}  // namespace
}  // namespace kerf::datagram::replay_window_test
