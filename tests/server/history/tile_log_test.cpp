// SPDX-License-Identifier: Apache-2.0
#include "server/history/tile_log.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

namespace kerf {
namespace {

TEST(TileLog, RunsHoldEveryMotionAndGroupsShareNone) {
  std::mt19937 random(1);
  TileLog log;
  std::map<std::uint64_t, StrokeId> added;
  std::uint64_t record = 0;
  std::map<std::size_t, StrokeId> strokes;
  for (int n = 0; n < 200'000; ++n) {
    // Twelve hands that come and go; each begins a stroke now and then.
    const std::size_t hand = random() % 12;
    record += random() % 40 == 0 ? 1 + random() % 500 : 1;
    if (random() % 50 == 0 || strokes[hand] == 0) strokes[hand] = record;
    log.add(record, strokes[hand]);
    added[record] = strokes[hand];
  }
  ASSERT_LE(log.groups().size(), TileLog::kGroupsMax);
  EXPECT_GE(log.groups().size(), TileLog::kGroupsMax / 4);
  std::uint64_t before = 0, motions = 0;
  auto next = added.begin();
  for (std::size_t n = 0; n < log.groups().size(); ++n) {
    const MotionGroup& group = log.groups()[n];
    EXPECT_GT(group.first, before);
    before = group.last;
    motions += group.motions;
    std::set<std::pair<StrokeId, std::uint64_t>> held;
    for (const MotionRun& run : log.runs(n)) {
      ASSERT_GE(run.first, group.first);
      ASSERT_LE(run.last, group.last);
      ASSERT_LE(run.first, run.last);
      for (std::uint64_t r = run.first; r <= run.last; ++r) {
        ASSERT_TRUE(held.emplace(run.stroke, r).second);  // no motion is cut twice
      }
    }
    for (; next != added.end() && next->first <= group.last; ++next) {
      ASSERT_TRUE(held.contains({next->second, next->first})) << "record " << next->first;
    }
  }
  EXPECT_EQ(next, added.end());
  EXPECT_EQ(motions, added.size());
}

TEST(TileLog, ATickOverATileTakesAFractionOfAByte) {
  TileLog log;
  // Four hands in turn, each over the tile for 25 of its ticks.
  std::uint64_t record = 0;
  for (int visit = 0; visit < 4000; ++visit) {
    const std::uint64_t stroke = record + 1;
    record += 5000;
    for (int tick = 0; tick < 25; ++tick) log.add(record += 4, stroke);
  }
  EXPECT_LT(static_cast<double>(log.bytes()) / 100'000, 0.6);
}

}  // namespace
}  // namespace kerf
