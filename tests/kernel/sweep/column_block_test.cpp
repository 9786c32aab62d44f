// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/column_block.h"

#include "tests/support/test.h"

namespace kerf::column_block_test {
namespace {

/// A block whose stock reaches up to 10 mm.
ColumnBlock block() {
  ColumnBlock b;
  b.top_mm = 10;
  b.lowest_mm = Lanes(-100);
  b.clear();
  return b;
}

void expect_interval(const ColumnBlock& b, int row, int lane, double lo, double hi) {
  EXPECT_EQ(b.lo_mm[row][lane], lo) << lane;
  EXPECT_EQ(b.hi_mm[row][lane], hi) << lane;
}

TEST(ColumnBlock, EmptyFirstIntervalLeavesNoEnds) {
  ColumnBlock b = block();
  // A ball above the stock: its upper end is cut to the stock's top and is below its lower end.
  b.add(0, Lanes(12), Lanes(10));
  b.add(0, Lanes(3), Lanes(5));
  for (int lane = 0; lane < kLanes; ++lane) expect_interval(b, 0, lane, 3, 5);
  EXPECT_TRUE(b.apart.empty());
}

TEST(ColumnBlock, IntervalsAboveTheStockAreIgnored) {
  for (const bool first : {true, false}) {
    ColumnBlock b = block();
    if (first) b.add(2, Lanes(11), Lanes(20));
    b.add(2, Lanes(3), Lanes(5));
    if (!first) b.add(2, Lanes(11), Lanes(20));
    for (int lane = 0; lane < kLanes; ++lane) expect_interval(b, 2, lane, 3, 5);
    EXPECT_TRUE(b.apart.empty());
  }
}

TEST(ColumnBlock, ColumnsOfARowAreIndependent) {
  ColumnBlock b = block();
  Lanes lo(1), hi(2), lo2(1.5), hi2(4);
  lo.set(3, 12);  // above the stock
  hi.set(3, 10);
  lo2.set(5, 3);  // apart from the first
  b.add(1, lo, hi);
  b.add(1, lo2, hi2);
  expect_interval(b, 1, 0, 1, 4);
  expect_interval(b, 1, 3, 1.5, 4);
  expect_interval(b, 1, 5, 1, 2);
  ASSERT_EQ(b.apart.size(), 1u);
  EXPECT_EQ(b.apart[0].row, 1);
  EXPECT_EQ(b.apart[0].lo_mm[5], 3);
  EXPECT_EQ(b.apart[0].hi_mm[5], 4);
  EXPECT_GT(b.apart[0].lo_mm[0], b.apart[0].hi_mm[0]);
}

TEST(ColumnBlock, BridgeJoinsIntervalsThatWereApart) {
  ColumnBlock b = block();
  b.join_mm = 0.125;
  b.add(0, Lanes(1), Lanes(2));
  b.add(0, Lanes(5), Lanes(6));
  ASSERT_EQ(b.apart.size(), 1u);
  b.add(0, Lanes(2.0625), Lanes(4.875));
  for (int lane = 0; lane < kLanes; ++lane) {
    expect_interval(b, 0, lane, 1, 6);
    EXPECT_GT(b.apart[0].lo_mm[lane], b.apart[0].hi_mm[lane]);
  }
}

TEST(ColumnBlock, GrowingIntervalNeedsOneEntry) {
  ColumnBlock b = block();
  b.add(0, Lanes(8), Lanes(9));
  for (int k = 0; k < 1000; ++k) b.add(0, Lanes(k * 0.005), Lanes(k * 0.005 + 0.01));
  ASSERT_EQ(b.apart.size(), 1U);
  EXPECT_EQ(b.apart[0].lo_mm[0], 0);
  EXPECT_EQ(b.apart[0].hi_mm[0], 999 * 0.005 + 0.01);
}

using Interval = std::pair<double, double>;

/// Returns the intervals of a column, sorted.
std::vector<Interval> intervals(const ColumnBlock& b, int row, int lane) {
  std::vector<Interval> all{{b.lo_mm[row][lane], b.hi_mm[row][lane]}};
  for (const ColumnBlock::Apart& a : b.apart) {
    if (a.row == row) all.emplace_back(a.lo_mm[lane], a.hi_mm[lane]);
  }
  std::erase_if(all, [](const Interval& i) { return i.first > i.second; });
  std::ranges::sort(all);
  return all;
}

/// Returns the union of intervals with gaps up to `join` closed.
std::vector<Interval> closed_union(std::vector<Interval> all, double join) {
  std::ranges::sort(all);
  std::vector<Interval> joined;
  for (const Interval& i : all) {
    if (!joined.empty() && i.first <= joined.back().second + join) {
      joined.back().second = std::max(joined.back().second, i.second);
    } else {
      joined.push_back(i);
    }
  }
  return joined;
}

TEST(ColumnBlock, AnyOrderGivesTheUnionWithGapsClosed) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-20, 9.9), size(0, 3);
  for (int round = 0; round < 400; ++round) {
    const int count = 2 + round % 8;
    std::vector<std::pair<Lanes, Lanes>> added;
    for (int n = 0; n < count; ++n) {
      Lanes lo, hi;
      for (int lane = 0; lane < kLanes; ++lane) {
        const double from = place(random);
        lo.set(lane, from);
        hi.set(lane, from + size(random));
      }
      added.emplace_back(lo, hi);
    }
    for (int order = 0; order < 6; ++order) {
      std::ranges::shuffle(added, random);
      ColumnBlock b = block();
      b.join_mm = 0.5;
      for (const auto& [lo, hi] : added) b.add(3, lo, hi);
      for (int lane = 0; lane < kLanes; ++lane) {
        std::vector<Interval> column;
        for (const auto& [lo, hi] : added) column.emplace_back(lo[lane], hi[lane]);
        ASSERT_EQ(intervals(b, 3, lane), closed_union(column, b.join_mm));
      }
    }
  }
}

}  // namespace
}  // namespace kerf::column_block_test
