// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/moving_slice.h"

#include "tests/support/test.h"

namespace kerf::moving_slice_test {
namespace {

constexpr double kToleranceMm = 0.001, kTopMm = 3;

const ToolPiece kSlices[] = {
    FrustumPiece{0, 5, 8, 5},     FrustumPiece{0, 6, 3, 6},  FrustumPiece{0, 6, 6, 3},
    FrustumPiece{0, 0, 5, 5},     FrustumPiece{1, 2, 9, 4},  ArcPiece{3, 2, 2, 0, 2},
    ArcPiece{0, 5, 5, 0, 5},      ArcPiece{1.5, 4, 4, 0, 8}, ArcPiece{-24.9954541, 12, 30, 0, 24},
    ArcPiece{2, 1, 1.5, 0.2, 1.8}};

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double in(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine_); }
  Vec3 vec(double z) { return {in(-1, 1), in(-1, 1), z * in(-1, 1)}; }

 private:
  std::mt19937_64 engine_;
};

/// A slice on a motion, and a block of columns next to it or below it.
struct Sample {
  ToolPiece slice;
  ToolPose from, to;
  SliceSearch search;
  ColumnBlock block;

  MovingSlice moving() const { return {slice, from, to, {true, true}, search}; }
};

Sample sample(int k, Random& random, double greatest_turn = 0.004) {
  Sample s;
  s.slice = kSlices[std::size_t(k) % std::size(kSlices)];
  const double lean = k % 3 == 0 ? 0.05 : 0.4, turn = k % 5 == 0 ? 0 : greatest_turn, step = 0.15;
  s.from.axis = normalized(random.vec(0) * lean + Vec3{0, 0, 1});
  s.from.tip_mm = {0, 0, 0};
  s.to.axis = turn > 0 ? normalized(s.from.axis + random.vec(1) * turn) : s.from.axis;
  s.to.tip_mm = random.vec(0.5) * step;
  // The bend of such a motion is below the tolerance, so two stations suffice.
  s.search.bend_mm = 0.0015;
  s.search.top_mm = kTopMm;
  s.search.missed_mm = 0.9 * kToleranceMm;
  s.search.search_mm = 0.1 * kToleranceMm;
  const double pitch = random.in(0.05, 0.3), x = random.in(-7, 6), y = random.in(-7, 6);
  for (int i = 0; i < kLanes; ++i) s.block.x_mm.set(i, x + i * pitch);
  for (int j = 0; j < kBlockSide; ++j) s.block.y_mm[j] = y + j * pitch;
  s.block.rows = 0xFF;
  s.block.top_mm = kTopMm;
  s.block.lowest_mm = Lanes(-100);
  s.block.join_mm = kToleranceMm;
  s.block.clear();
  return s;
}

bool is_removed(const ColumnBlock& block, int row, int lane) {
  return (block.filled >> row & 1) != 0 && block.lo_mm[row][lane] <= block.hi_mm[row][lane];
}

/// Expects that a slice at rest at many poses of the motion removes no more than `block`, and that
/// the ends in `block` are reached at one of them, in the rows `rows`.
void expect_swept(const Sample& s, const ColumnBlock& block, unsigned rows,
                  const std::string& what) {
  constexpr int kPoses = 64;
  ColumnBlock all = s.block;
  const TurningFrame frame(s.from, s.to);
  for (int i = 0; i <= kPoses; ++i) {
    const TurningFrame::Poses at = frame.at(Lanes(double(i) / kPoses));
    const ToolPose pose{frame.tip + Vec3{at.tip.x[0], at.tip.y[0], at.tip.z[0]},
                        {at.u.x[0], at.u.y[0], at.u.z[0]}};
    all.rows = rows;
    MovingSlice(s.slice, pose, pose, {true, true}, s.search).evaluate(all);
  }
  const auto clipped = [](double z) { return std::min(z, kTopMm); };
  for (int row = 0; row < kBlockSide; ++row) {
    if ((rows >> row & 1) == 0) continue;
    for (int lane = 0; lane < kLanes; ++lane) {
      if (!is_removed(all, row, lane)) continue;
      ASSERT_TRUE(is_removed(block, row, lane)) << what << " row " << row << " lane " << lane;
      EXPECT_NEAR(block.lo_mm[row][lane], all.lo_mm[row][lane], 1e-3) << what;
      EXPECT_NEAR(clipped(block.hi_mm[row][lane]), clipped(all.hi_mm[row][lane]), 1e-3) << what;
    }
  }
}

TEST(MovingSlice, SimpleRowsMatchASweepOfPoses) {
  Random random(3);
  int simple = 0, rows = 0;
  for (int k = 0; k < 1500; ++k) {
    Sample s = sample(k, random);
    ColumnBlock block = s.block;
    s.moving().add_simple_rows(block);
    const unsigned done = 0xFFU & ~block.rows;
    simple += std::popcount(done);
    rows += std::popcount(block.filled & done);
    expect_swept(s, block, done, "sample " + std::to_string(k));
  }
  // Without such rows the test would test nothing.
  EXPECT_GT(simple, 3000);
  EXPECT_GT(rows, 1500);
}

TEST(MovingSlice, EvaluatedRowsMatchASweepOfPoses) {
  Random random(6);
  int rows = 0;
  for (int k = 0; k < 600; ++k) {
    Sample s = sample(k, random);
    s.search.bend_mm = 0.003;
    ColumnBlock block = s.block, simple = s.block;
    s.moving().add_simple_rows(simple);
    s.moving().evaluate(block);
    rows += std::popcount(block.filled & simple.rows);
    expect_swept(s, block, 0xFF, "sample " + std::to_string(k));
  }
  EXPECT_GT(rows, 500);
}

TEST(MovingSlice, RowsAreIndependentOfEachOther) {
  Random random(4);
  for (int k = 0; k < 1600; ++k) {
    Sample s = sample(k, random, k % 2 == 0 ? 0.004 : 0.12);
    s.search.parts = 1 + k % 3;
    const MovingSlice moving = s.moving();
    ColumnBlock together = s.block;
    moving.evaluate(together);
    for (int row = 0; row < kBlockSide; ++row) {
      ColumnBlock alone = s.block;
      alone.rows = 1U << row;
      moving.evaluate(alone);
      for (int lane = 0; lane < kLanes; ++lane) {
        ASSERT_EQ(is_removed(alone, row, lane), is_removed(together, row, lane));
        if (!is_removed(alone, row, lane)) continue;
        EXPECT_EQ(alone.lo_mm[row][lane], together.lo_mm[row][lane]) << k;
        EXPECT_EQ(alone.hi_mm[row][lane], together.hi_mm[row][lane]) << k;
      }
    }
  }
}

/// Returns the parts of a column's stock that are removed, from the bottom up.
std::vector<std::pair<double, double>> removed_stock(const ColumnBlock& block, int row, int lane,
                                                     double stock_lo, double stock_hi) {
  std::vector<std::pair<double, double>> parts;
  const auto take = [&](double lo, double hi) {
    lo = std::max(lo, stock_lo);
    hi = std::min(hi, stock_hi);
    if (lo < hi) parts.push_back({lo, hi});
  };
  if (is_removed(block, row, lane)) take(block.lo_mm[row][lane], block.hi_mm[row][lane]);
  for (const ColumnBlock::Apart& a : block.apart) {
    if (a.row == row && a.lo_mm[lane] <= a.hi_mm[lane]) take(a.lo_mm[lane], a.hi_mm[lane]);
  }
  std::ranges::sort(parts);
  return parts;
}

TEST(MovingSlice, EndsBeyondTheStockDoNotChangeTheCut) {
  Random random(9);
  int shortened = 0;
  for (int k = 0; k < 2400; ++k) {
    Sample s = sample(k, random, k % 2 == 0 ? 0.004 : 0.03);
    s.search.parts = 1 + k % 3;
    s.search.checked = true;
    s.search.bend_mm = s.search.disc_bend_mm = 0.2;
    if (k % 7 == 0) s.from.axis = {1, 0, 0};
    if (k % 7 == 0) s.to.axis = normalized(s.from.axis + random.vec(1) * 0.02);
    const MovingSlice moving = s.moving();
    ColumnBlock whole = s.block, stock = s.block;
    for (std::size_t row = 0; row < kBlockSide; ++row) {
      for (int lane = 0; lane < kLanes; ++lane) {
        const double lo = random.in(-6, 3), hi = lo + random.in(-0.2, 6);
        stock.stock_lo_mm[row].set(lane, lo);
        stock.stock_hi_mm[row].set(lane, hi);
      }
    }
    moving.evaluate(whole);
    moving.evaluate(stock);
    for (int row = 0; row < kBlockSide; ++row) {
      for (int lane = 0; lane < kLanes; ++lane) {
        const double lo = stock.stock_lo_mm[std::size_t(row)][lane];
        const double hi = std::min(stock.stock_hi_mm[std::size_t(row)][lane], kTopMm);
        const auto lost = removed_stock(stock, row, lane, lo, hi);
        ASSERT_EQ(lost, removed_stock(whole, row, lane, lo, hi)) << k;
        if (!lost.empty()) shortened += (lost.front().first > lo) != (lost.back().second < hi);
      }
    }
  }
  EXPECT_GT(shortened, 5000);
}

TEST(MovingSlice, SinkingMillNeedsOnlyItsLastPose) {
  const ToolPose from{{0, 0, 1}, {0, 0, 1}}, to{{0.1, 0, 0.9}, {0, 0, 1}};
  Random random(5);
  Sample s = sample(0, random);
  for (int i = 0; i < kLanes; ++i) s.block.x_mm.set(i, i * 0.1);
  for (int j = 0; j < kBlockSide; ++j) s.block.y_mm[j] = j * 0.1;
  MovingSlice(FrustumPiece{0, 5, 8, 5}, from, to, {true, false}, {}).add_simple_rows(s.block);
  EXPECT_EQ(s.block.rows, 0U);
  for (int row = 0; row < kBlockSide; ++row) EXPECT_NEAR(s.block.lo_mm[row][3], 0.9, 1e-12);
}

TEST(MovingSlice, SinkingAndRisingBottomNeedsNoSearch) {
  Random random(8);
  Sample s = sample(0, random);
  s.slice = FrustumPiece{0, 5, 8, 5};
  // Below the middle of its path the bottom is lowest halfway, by 0.025 mm.
  s.from = {{-0.5, 0, 0}, normalized(Vec3{-0.05, 0, 1})};
  s.to = {{0.5, 0, 0}, normalized(Vec3{0.05, 0, 1})};
  s.search.search_mm = 1e-3;
  // The bend of its path, 2 turn * 1 mm, and a tolerance for which one part suffices.
  s.search.bend_mm = s.search.disc_bend_mm = 0.2;
  s.search.missed_mm = 0.03;
  for (int i = 0; i < kLanes; ++i) s.block.x_mm.set(i, -0.1 + i * 0.025);
  for (int j = 0; j < kBlockSide; ++j) s.block.y_mm[j] = j * 0.1;
  ColumnBlock block = s.block;
  MovingSlice(s.slice, s.from, s.to, {true, false, true}, s.search).add_simple_rows(block);
  EXPECT_EQ(block.rows, 0U);
  expect_swept(s, block, 0xFF, "bottom");
  EXPECT_NEAR(block.lo_mm[0][4], 0, 1e-3);
}

}  // namespace
}  // namespace kerf::moving_slice_test
