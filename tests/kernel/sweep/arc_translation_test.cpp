// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/arc_translation.h"

#include "kernel/sweep/frustum_translation.h"
#include "tests/support/test.h"

namespace kerf::arc_translation_test {
namespace {

/// Returns the argument at which a convex function is least in [a, b].
template <class Function>
double least_at(Function f, double a, double b) {
  constexpr double kGolden = 0.6180339887498949;
  double x = b - kGolden * (b - a), y = a + kGolden * (b - a), fx = f(x), fy = f(y);
  for (int i = 0; i < 70; ++i) {
    if (fx < fy) {
      b = y;
      y = x;
      fy = fx;
      x = b - kGolden * (b - a);
      fx = f(x);
    } else {
      a = x;
      x = y;
      fx = fy;
      y = a + kGolden * (b - a);
      fy = f(y);
    }
  }
  return (a + b) / 2;
}

/// A translated arc, judged by its convex distance function alone.
struct Reference {
  ArcPiece piece;
  ToolPose from, to;

  /// Distance of a point from the piece after a share of the motion; negative inside.
  double distance(Vec3 point, double share) const {
    const Vec3 q = point - from.tip_mm - (to.tip_mm - from.tip_mm) * share;
    const double h = dot(q, from.axis);
    const double rho = length(q - from.axis * h);
    return std::max({side_distance(piece, rho, h).mm, piece.z0_mm - h, h - piece.z1_mm});
  }
  /// Distance of a point from the swept volume.
  double off(Vec3 point) const {
    const auto at = [&](double share) { return distance(point, share); };
    return std::min({at(least_at(at, 0, 1)), at(0), at(1)});
  }
};

/// Returns a block of rays around a point of the motion.
ColumnBlock block_near(const Reference& sweep, std::mt19937_64& random) {
  const test::Uniform in(random);
  const double scale = in(0.02, 1.5);
  const Vec3 corner = sweep.from.tip_mm + (sweep.to.tip_mm - sweep.from.tip_mm) * in(0, 1) +
                      sweep.from.axis * sweep.piece.z0_mm - Vec3{in(0, 8), in(0, 8), 0} * scale;
  ColumnBlock block;
  for (int i = 0; i < kLanes; ++i) block.x_mm.set(i, corner.x + i * scale);
  for (int j = 0; j < kBlockSide; ++j) block.y_mm[j] = corner.y + j * scale;
  block.rows = 0xFF;
  block.top_mm = block.grid_top_mm = 1e300;
  block.clear();
  return block;
}

/// Expects every ray of a block around the motion to lose exactly the interval of the reference.
void expect_exact(const Reference& sweep, std::mt19937_64& random, const std::string& what) {
  constexpr double kAllowedMm = 2e-8, kFarMm = 80;
  ColumnBlock block = block_near(sweep, random);
  ArcTranslation(sweep.piece, sweep.piece, sweep.from, sweep.to, {true, true},
                 {.top_mm = block.top_mm})
      .evaluate(block);
  for (int j = 0; j < kBlockSide; j += 2) {
    for (int i = 0; i < kLanes; i += 2) {
      const bool filled = (block.filled >> j & 1) != 0 && block.lo_mm[j][i] <= block.hi_mm[j][i];
      const auto off = [&](double z) { return sweep.off({block.x_mm[i], block.y_mm[j], z}); };
      const double deepest = least_at(off, -kFarMm, kFarMm);
      if (!filled) {
        EXPECT_GT(off(deepest), -kAllowedMm) << what << ": missed at " << deepest;
        continue;
      }
      const double lo = block.lo_mm[j][i], hi = block.hi_mm[j][i];
      EXPECT_NEAR(off(lo), 0, kAllowedMm)
          << what << ": lower end " << lo << ", deepest " << deepest;
      EXPECT_NEAR(off(hi), 0, kAllowedMm)
          << what << ": upper end " << hi << ", deepest " << deepest;
      if (off(deepest) < -kAllowedMm) {
        EXPECT_LT(lo, deepest) << what;
        EXPECT_GT(hi, deepest) << what;
      }
    }
  }
}

const ArcPiece kArcs[] = {{3, 2, 2, 0, 2},  // the corner of a bull-nose
                          {3, 0.05, 0.05, 0, 0.05}, {-24.9954541, 12, 30, 0, 24},  // a barrel
                          {1.5, 7.7, 4, 4, 11},                                    // a belt
                          {0, 5, 5, 0, 3},  // the tip of a ball
                          {0.001, 5, 5, 0, 7}};

TEST(ArcTranslation, RemovesExactlyTheSweptVolume) {
  std::mt19937_64 random(7);
  const test::Uniform in(random);
  for (int k = 0; k < 150; ++k) {
    const ArcPiece& arc = kArcs[k % std::size(kArcs)];
    const Vec3 axis = normalized({in(-1, 1), in(-1, 1), in(-1, 1)});
    const Vec3 d = Vec3{in(-1, 1), in(-1, 1), in(-1, 1)} * (k % 3 == 0 ? 10 : 0.4);
    const Vec3 tip{in(-1, 1), in(-1, 1), in(-1, 1)};
    expect_exact({arc, {tip, axis}, {tip + d, axis}}, random, "motion " + std::to_string(k));
  }
}

TEST(ArcTranslation, SpecialDirectionsAreExactToo) {
  std::mt19937_64 random(8);
  const Vec3 leaning = normalized({0.3, -0.2, 1});
  for (const ArcPiece& arc : kArcs) {
    for (const Vec3 axis :
         {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{0, -1, 0}, leaning}) {
      for (const Vec3 d : {Vec3{1, 0, 0}, Vec3{0, -2, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1},
                           Vec3{1, 0, -0.01}, Vec3{1, 0, 1e-9}, Vec3{1e-6, 0, -1}, leaning * 2,
                           cross(leaning, Vec3{1, 0, 0}), Vec3{1e-9, 0, 0}}) {
        const Vec3 tip{0.1371, -0.2, 0.3};
        expect_exact({arc, {tip, axis}, {tip + d, axis}}, random,
                     "arc " + std::to_string(&arc - kArcs) + ", axis " + std::to_string(axis.x) +
                         " " + std::to_string(axis.y) + ", d " + std::to_string(d.x) + " " +
                         std::to_string(d.y) + " " + std::to_string(d.z));
      }
    }
  }
}

/// The remainder of a sweep whose first pose has already been removed, together with that pose,
/// equals the whole sweep, to the bit. A piece of the tool may be a cone as well.
template <class Translation, class Piece>
void expect_rest(const Piece& piece, const Reference& sweep, std::mt19937_64& random, int& rests) {
  ColumnBlock all = block_near(sweep, random), left = all, start = all;
  const ShownDiscs shown{true, true};
  const SliceSearch search{.top_mm = all.top_mm};
  Translation translation(piece, piece, sweep.from, sweep.to, shown, search);
  translation.evaluate(all);
  translation.set_trail(Trail(piece, sweep.from, sweep.to, shown));
  translation.evaluate(left);
  MovingSlice(piece, sweep.from, sweep.from, shown, search).evaluate(start);
  const auto is_in = [](const ColumnBlock& b, int row, int lane) {
    return (b.filled >> row & 1) != 0 && b.lo_mm[row][lane] <= b.hi_mm[row][lane];
  };
  for (int j = 0; j < kBlockSide; ++j) {
    for (int i = 0; i < kLanes; ++i) {
      if (!is_in(all, j, i)) continue;
      const double lo = all.lo_mm[j][i], hi = all.hi_mm[j][i];
      if (!is_in(start, j, i)) {
        EXPECT_EQ(left.lo_mm[j][i], lo);
        EXPECT_EQ(left.hi_mm[j][i], hi);
        continue;
      }
      ASSERT_TRUE(is_in(left, j, i));
      EXPECT_EQ(std::min(left.lo_mm[j][i], start.lo_mm[j][i]), lo);
      EXPECT_EQ(std::max(left.hi_mm[j][i], start.hi_mm[j][i]), hi);
      EXPECT_LE(left.lo_mm[j][i], start.hi_mm[j][i]);
      EXPECT_GE(left.hi_mm[j][i], start.lo_mm[j][i]);
      rests += left.lo_mm[j][i] > lo || left.hi_mm[j][i] < hi;
    }
  }
}

TEST(ArcTranslation, FirstPoseAndRemainderEqualTheWholeSweep) {
  std::mt19937_64 random(11);
  const test::Uniform in(random);
  const FrustumPiece cones[] = {{0, 5, 6, 5}, {0, 5, 6, 2}, {1, 0, 5, 4}};
  int arcs = 0, frusta = 0;
  for (int k = 0; k < 1200; ++k) {
    const Vec3 axes[] = {{0, 0, 1}, {1, 0, 0}, normalized(Vec3{in(-1, 1), in(-1, 1), in(-1, 1)})};
    const Vec3 axis = axes[k / 6 % 3], tip{in(-1, 1), in(-1, 1), in(-1, 1)};
    const Vec3 d = Vec3{in(-1, 1), in(-1, 1), k % 4 == 0 ? 0 : in(-1, 1)} * (k % 5 == 0 ? 10 : 1);
    const ArcPiece& arc = kArcs[k % std::size(kArcs)];
    const Reference sweep{arc, {tip, axis}, {tip + d, axis}};
    expect_rest<ArcTranslation>(arc, sweep, random, arcs);
    expect_rest<FrustumTranslation>(cones[k % 3], sweep, random, frusta);
  }
  EXPECT_GT(arcs, 1000);
  EXPECT_GT(frusta, 1000);
}

}  // namespace
}  // namespace kerf::arc_translation_test
