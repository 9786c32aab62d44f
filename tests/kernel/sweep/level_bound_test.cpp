// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/level_bound.h"

#include "kernel/cut/swept_block.h"
#include "kernel/math/tolerance.h"
#include "kernel/sculpture.h"
#include "kernel/sweep/swept_tool.h"
#include "tests/support/test.h"

namespace kerf::level_bound_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRoundingMm = 1e-12, kMarginsMm = 3 * kEdgeEpsilonMm;
constexpr Vec3 kUp{0, 0, 1};

/// The result of a level bound for one disc.
struct Said {
  double lowest;
  bool gone;
};

Said ask(const LevelBound& bound, double x, double y, double reach) {
  Lanes z = Lanes(kInfinity);
  const unsigned gone = bound.lower_bound({Lanes(x), Lanes(y), reach}, z);
  return {z[0], gone != 0};
}

LevelBound moved(const ToolPiece& slice, Vec3 from, Vec3 to, bool start_is_cut) {
  LevelBound bound = LevelBound::make(slice, {from, kUp}, {to, kUp}).value();
  if (start_is_cut) bound.set_start_is_cut();
  return bound;
}

TEST(LevelBound, ExistsForUprightToolsThatMoveLevel) {
  const FrustumPiece mill{0, 4, 50, 4};
  EXPECT_TRUE(LevelBound::make(mill, {{0, 0, 1}, kUp}, {{3, 4, 1}, kUp}));
  EXPECT_FALSE(LevelBound::make(mill, {{0, 0, 1}, kUp}, {{3, 4, 1.0000001}, kUp}));
  const Vec3 leaning = normalized(Vec3{1e-9, 0, 1});
  EXPECT_FALSE(LevelBound::make(mill, {{0, 0, 1}, leaning}, {{3, 4, 1}, leaning}));
  EXPECT_FALSE(LevelBound::make(mill, {{0, 0, 1}, -kUp}, {{3, 4, 1}, -kUp}));
}

TEST(LevelBound, IsTheHeightOfTheProfileAtTheNearestPointOfADisc) {
  const LevelBound countersink = moved(FrustumPiece{0, 1, 4, 5}, {0, 0, 3}, {2, 0, 3}, false);
  EXPECT_NEAR(ask(countersink, 1, 3.5, 0.5).lowest, 3 + 2, kMarginsMm);
  EXPECT_NEAR(ask(countersink, 1, 1, 0.5).lowest, 3, kMarginsMm);
  EXPECT_EQ(ask(countersink, 1, 5.6, 0.5).lowest, kInfinity);
  const LevelBound corner = moved(ArcPiece{3, 2, 2, 0, 2}, {0, 0, 3}, {0, 2, 3}, false);
  EXPECT_NEAR(ask(corner, 4.5, 1, 0.5).lowest, 3 + 2 - std::sqrt(4 - 1.0), kMarginsMm);
  EXPECT_NEAR(ask(corner, 0, 6.5, 0.5).lowest, 3 + 2 - std::sqrt(4 - 1.0), kMarginsMm);
}

TEST(LevelBound, SkipsDiscsBehindAndInsideTheFirstPose) {
  const LevelBound mill = moved(FrustumPiece{0, 4, 50, 4}, {0, 0, 0}, {1, 0, 0}, true);
  EXPECT_EQ(ask(mill, -0.6, 3.8, 0.5).lowest, kInfinity);
  EXPECT_FALSE(ask(mill, -0.4, 3.8, 0.5).gone);  // a part of the disc is passed by the motion
  EXPECT_NEAR(ask(mill, -0.4, 3.8, 0.5).lowest, 0, kMarginsMm);
  EXPECT_TRUE(ask(mill, 3.4, 0, 0.5).gone);
  EXPECT_FALSE(ask(mill, 3.6, 0, 0.5).gone);
  // Within the lower disc of a dovetail, but beyond the upper one.
  const LevelBound dovetail = moved(FrustumPiece{0, 6, 6, 3}, {0, 0, 0}, {1, 0, 0}, true);
  EXPECT_TRUE(ask(dovetail, 2, 0, 0.5).gone);
  EXPECT_FALSE(ask(dovetail, 3, 0, 0.5).gone);
  const LevelBound uncut = moved(FrustumPiece{0, 4, 50, 4}, {0, 0, 0}, {1, 0, 0}, false);
  EXPECT_FALSE(ask(uncut, 2, 0, 0.5).gone);
  EXPECT_NEAR(ask(uncut, -3, 0, 0.5).lowest, 0, kMarginsMm);
}

const ToolPiece kSlices[] = {FrustumPiece{0, 4, 12, 4},    FrustumPiece{1, 2, 6, 5},
                             FrustumPiece{2, 5, 6, 1},     FrustumPiece{0, 0, 2, 5},
                             ArcPiece{3, 2, 2, 0, 2},      ArcPiece{-24.9954541, 12, 30, 0, 24},
                             ArcPiece{1.5, 7.7, 4, 4, 11}, ArcPiece{0, 5, 5, 0, 3}};

/// Points of moving slices over a disc are above its bound, or in the first pose if it is cut.
/// Points over discs that are gone are in the first pose.
TEST(LevelBound, BoundsEveryPointOfTheMovingSlice) {
  std::mt19937_64 random(5);
  const test::Uniform in(random);
  int bounded = 0, left_out = 0, gone = 0;
  for (int trial = 0; trial < 6000; ++trial) {
    const ToolPiece& slice = kSlices[trial % std::size(kSlices)];
    const Extent e = extent(slice);
    const Vec3 from{in(-1, 1), in(-1, 1), in(-1, 1)};
    const Vec3 d{in(-2, 2), in(-2, 2), 0};
    const bool start_is_cut = trial % 3 != 0;
    const LevelBound bound = moved(slice, from, from + d, start_is_cut);
    const double reach = in(0, 1), x = in(-7, 7), y = in(-7, 7);
    const Said said = ask(bound, x, y, reach);
    (said.gone ? gone : said.lowest < kInfinity ? bounded : left_out)++;
    for (int sample = 0; sample < 60; ++sample) {
      const double off = reach * (sample % 2 == 0 ? 1 : std::sqrt(in(0, 1)));
      const double angle = in(0, 2 * std::numbers::pi);
      const double px = x + off * std::cos(angle), py = y + off * std::sin(angle);
      const double l = sample % 3 == 0 ? e.z0_mm : in(e.z0_mm, e.z1_mm), share = in(0, 1);
      const double radius = radius_at(slice, l);
      if (std::hypot(px - from.x - share * d.x, py - from.y - share * d.y) > radius) continue;
      const bool was_cut = std::hypot(px - from.x, py - from.y) <= radius + kRoundingMm;
      if (said.gone) {
        ASSERT_TRUE(start_is_cut && was_cut) << trial;
      } else if (!(start_is_cut && was_cut)) {
        ASSERT_GE(from.z + l, said.lowest - kRoundingMm) << trial;
      }
    }
  }
  EXPECT_GT(bounded, 500);
  EXPECT_GT(left_out, 500);
  EXPECT_GT(gone, 100);
}

SculptureSettings settings_of(Rays rays) {
  return SculptureSettings{
      .stock = BoxStock{{-9, -9, -6}, {9, 9, 0}}, .rays = rays, .pitch_mm = 0.2};
}

const ToolShape kShapes[] = {
    FlatShape{6, 30},
    TaperShape{3, 12, 30},
    BullNoseShape{6, 1, 30},
    AptShape{10, 1.5, 3.630717035815369, 2.0250053615596113, 8, 6, 40},
    ProfileShape{{ProfilePoint{0, 0}, ProfileArc{{1, 5.828}, 3}, ProfilePoint{1, 30}}},
    ProfileShape{{ProfilePoint{2, 0}, ProfileArc{{3, 12}, 40}}},
    ProfileShape{{ProfilePoint{0, 0}, ProfilePoint{4, 0}, ProfilePoint{4, 2}, ProfilePoint{1.5, 2},
                  ProfilePoint{1.5, 30}}},
    ProfileShape{{ProfilePoint{4, 0}, ProfilePoint{2, 4}, ProfilePoint{2, 30}}}};

/// One tool, each of whose starts is known to be cut, and two tools of equal shape in turn, whose
/// starts are not.
TEST(LevelBound, SkippedPartsWereAlreadyRemoved) {
  std::mt19937_64 random(7);
  const test::Uniform in(random);
  for (const ToolShape& shape : kShapes) {
    auto one = *Sculpture::create(settings_of(Rays::kDexel));
    auto two = *Sculpture::create(settings_of(Rays::kDexel));
    for (const ToolId id : {1u, 2u}) {
      one.apply(DefineTool{id, *make_tool(shape)}).value();
      two.apply(DefineTool{id, *make_tool(shape)}).value();
    }
    ToolPose last{{in(-6, 6), in(-6, 6), in(-5, -3)}, kUp};
    for (ToolId i = 0; i < 40; ++i) {
      const ToolPose next{{in(-6, 6), in(-6, 6), last.tip_mm.z}, kUp};
      one.apply(MoveTool{1, last, next, 0}).value();
      two.apply(MoveTool{1 + i % 2, last, next, 0}).value();
      ASSERT_EQ(one.removed_volume_mm3(), two.removed_volume_mm3()) << shape.index() << " " << i;
      last = next;
    }
    EXPECT_EQ(one.state_hash(), two.state_hash()) << shape.index();
  }
}

/// The seam of two pieces may not be rounded twice, so the removed interval of one is joined to
/// that of the other.
TEST(LevelBound, RemovedPartsJoinTheIntervalsOfNeighbors) {
  const Tool slot = *make_tool(kShapes[6]);
  const auto block = *Sculpture::create(settings_of(Rays::kDexel));
  const DexelGrid& grid = block.grid();
  const ToolPose from{{0, 0, -4}, kUp}, to{{2, 0, -4}, kUp};
  const SweepSettings settings{MotionModel::kTight, 0.01, {{-9, -9, -6}, {9, 9, 0}}, true};
  sweep_tool(slot, make_motion(from, to, slot.length_mm), settings, [&](SubMotion&& part) {
    // The neck, of a radius of 1.5 mm, reaches these columns; the head held them at the start.
    const auto i = std::int32_t((9 + 2.8) / grid.pitch_mm) / 8 * 8;
    const auto j = std::int32_t(9 / grid.pitch_mm) / 8 * 8;
    ColumnBlock columns;
    sweep_block(part.swept, grid, nullptr, i, j, columns);
    ASSERT_NE(columns.filled, 0u);
    int joined = 0;
    for (int row = 0; row < kBlockSide; ++row) {
      for (int c = 0; c < kLanes; ++c) {
        if (std::hypot(columns.x_mm[c] - 2, columns.y_mm[row]) > 1.4) continue;
        EXPECT_NEAR(columns.lo_mm[row][c], -4, 1e-9);
        EXPECT_GE(columns.hi_mm[row][c], -kRoundingMm);
        ++joined;
      }
    }
    EXPECT_GT(joined, 8);
  });
}

}  // namespace
}  // namespace kerf::level_bound_test
