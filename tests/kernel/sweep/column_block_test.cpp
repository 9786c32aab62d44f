// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/column_block.h"

#include <gtest/gtest.h>

namespace kerf {
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
  // A ball above the stock: its upper end is cut to the stock's top and lies below its lower end.
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

}  // namespace
}  // namespace kerf
