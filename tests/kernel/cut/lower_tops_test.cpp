// SPDX-License-Identifier: Apache-2.0
// The fused pass of a ball against the evaluation and the subtraction that it replaces.

#include "kernel/cut/lower_tops.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <random>
#include <vector>

#include "kernel/cut/subtract_rows.h"
#include "kernel/dexel/dexel_tile.h"

namespace kerf::lower_tops_test {
namespace {

constexpr double kRadiusMm = 3;
constexpr std::int32_t kHeight = 1 << 20;

using Depths = std::array<std::int32_t, kTileSide * kBlockSide>;

DexelGrid grid() {
  DexelGrid g;
  g.pitch_mm = 0.25;
  g.z_quantum_mm = std::ldexp(1.0, -18);
  g.columns_x = g.columns_y = kTileSide;
  g.height_quanta = kHeight;
  return g;
}

class Random {
 public:
  double in(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine_); }

 private:
  std::mt19937_64 engine_{5};
};

/// A chain of one to three lines above the height 4 mm, over or near the block.
BallSweep ball(Random& random, int lines) {
  std::vector<Vec3> centers{{random.in(-3, 5), random.in(-3, 5), random.in(4, 6.5)}};
  const bool level = random.in(0, 1) < 0.3;
  for (int n = 0; n < lines; ++n) {
    const Vec3 step{random.in(-1, 1), random.in(-1, 1), level ? 0 : random.in(-0.5, 0.5)};
    centers.push_back(centers.back() + step);
    centers.back().z = std::max(centers.back().z, 4.0);
  }
  return {centers, kRadiusMm, lines % 2 == 0};
}

/// Columns of a height of at most 4 mm, some of them low, short or empty.
void fill(Random& random, Depths& bottom, Depths& top) {
  for (std::size_t c = 0; c < top.size(); ++c) {
    top[c] = static_cast<std::int32_t>(random.in(0.2, 1) * kHeight);
    bottom[c] = random.in(0, 1) < 0.5 ? 0 : static_cast<std::int32_t>(random.in(0, 0.9) * top[c]);
    if (random.in(0, 1) < 0.1) top[c] = bottom[c] = 0;
  }
}

ColumnBlock place(const DexelGrid& g) {
  ColumnBlock block;
  for (int c = 0; c < kLanes; ++c) block.x_mm.set(c, g.x_mm(c));
  for (int r = 0; r < kBlockSide; ++r) block.y_mm[r] = g.y_mm(r);
  block.top_mm = block.grid_top_mm = g.z_mm(kHeight);
  block.join_mm = 1e-9;
  block.lowest_mm = Lanes(-100);
  block.clear();
  return block;
}

void expect_equal(const RemovedGroup& a, const RemovedGroup& b) {
  EXPECT_EQ(a.i, b.i);
  EXPECT_EQ(a.j, b.j);
  EXPECT_TRUE(std::ranges::equal(a.bottom, b.bottom));
  EXPECT_TRUE(std::ranges::equal(a.top, b.top));
}

TEST(LowerTops, EqualsEvaluationAndSubtraction) {
  Random random;
  const DexelGrid g = grid();
  const std::uint32_t no_split[kBlockSide] = {};
  int changed = 0, unchanged = 0;
  for (int k = 0; k < 4000; ++k) {
    const BallSweep sweep = ball(random, 1 + k % 3);
    ColumnBlock block = place(g);
    ASSERT_TRUE(sweep.stays_above(block.top_mm));
    const unsigned rows = k % 4 == 0 ? 0xFF : static_cast<unsigned>(random.in(1, 256));
    Depths bottom, top;
    fill(random, bottom, top);

    block.rows = rows;
    sweep.evaluate(block);
    RemovedGroup expected[kBlockSide], groups[kBlockSide];
    BlockChange change;
    subtract_rows(block, block.filled, g, {bottom.data(), top.data(), no_split, 0, kTileSide}, 8,
                  16, expected, change);
    ASSERT_EQ(change.left_overs, 0);

    Depths new_bottom = bottom, new_top = top;
    const LoweredTops lowered =
        lower_tops(sweep, block, rows, g, {new_bottom.data(), new_top.data()}, 8, 16, groups);

    ASSERT_EQ(lowered.groups, std::popcount(change.changed));
    EXPECT_EQ(lowered.quanta, change.quanta);
    for (int n = 0; n < lowered.groups; ++n) expect_equal(groups[n], expected[n]);
    std::int32_t highest = 0;
    for (int r = 0; r < kBlockSide; ++r) {
      const bool changes = (change.changed >> r & 1) != 0;
      ++(changes ? changed : unchanged);
      for (int c = 0; c < kLanes; ++c) {
        const auto at = std::size_t(r * kTileSide + c);
        EXPECT_EQ(new_bottom[at], changes ? change.rows[r].bottom[c] : bottom[at]);
        EXPECT_EQ(new_top[at], changes ? change.rows[r].top[c] : top[at]);
        highest = std::max(highest, new_top[at]);
      }
    }
    EXPECT_EQ(lowered.highest, highest);
  }
  EXPECT_GT(changed, 3000);
  EXPECT_GT(unchanged, 3000);
}

TEST(LowerTops, BallBelowTheTopDoesNotOpenUpwards) {
  const BallSweep sinking({{0, 0, 5}, {0, 0, 3}}, kRadiusMm, false);
  EXPECT_TRUE(sinking.stays_above(3));
  EXPECT_FALSE(sinking.stays_above(3.1));
}

}  // namespace
}  // namespace kerf::lower_tops_test
