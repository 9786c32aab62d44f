// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/trail.h"

#include "kernel/cut/swept_block.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/sculpture.h"
#include "kernel/sculpture_motion.h"
#include "kernel/sweep/swept_tool.h"
#include "tests/support/test.h"

namespace kerf::trail_test {
namespace {

constexpr double kToleranceMm = 0.001;

Discs discs_at(double x, double y, double reach) { return {Lanes(x), Lanes(y), reach}; }

TEST(Trail, CylinderMovingSidewaysRemovesNothingBehindItsAxis) {
  const ToolPose from{{0, 0, 0}, {0, 0, 1}}, to{{1, 0, 0}, {0, 0, 1}};
  const Trail trail(FrustumPiece{5, 4, 50, 4}, from, to, {});
  EXPECT_EQ(trail.behind(discs_at(-1, 2, 0.5)), 0xFFU);
  EXPECT_EQ(trail.behind(discs_at(-0.4, 2, 0.5)), 0U);  // half of it may advance
  EXPECT_EQ(trail.behind(discs_at(3, 0, 0.5)), 0U);
}

TEST(Trail, ExposedDiscCountsOnlyWhereItMovesOutwards) {
  const FrustumPiece mill{0, 4, 50, 4};
  const Discs behind = discs_at(-2.5, 1, 0.5);
  const auto test = [&](Vec3 to_tip, Vec3 to_axis, ShownDiscs shown) {
    return Trail(mill, {{0, 0, 0}, {0, 0, 1}}, {to_tip, normalized(to_axis)}, shown).behind(behind);
  };
  EXPECT_EQ(test({1, 0, 0}, {0, 0, 1}, {true, false}), 0xFFU);
  EXPECT_EQ(test({1, 0, -1e-8}, {0, 0, 1}, {true, false}), 0U);
  EXPECT_EQ(test({1, 0, -1e-8}, {0, 0, 1}, {false, true}), 0xFFU);
  EXPECT_EQ(test({1, 0, 1e-8}, {0, 0, 1}, {true, false}), 0xFFU);
  EXPECT_EQ(test({1, 0, 1e-8}, {0, 0, 1}, {false, true}), 0U);
  // The rear of the bottom rises if the axis turns forwards about the tip, and sinks if it turns
  // backwards.
  EXPECT_EQ(test({1, 0, 0.03}, {0.01, 0, 1}, {true, false}), 0xFFU);
  EXPECT_EQ(test({1, 0, 0.01}, {-0.02, 0, 1}, {true, false}), 0U);
}

TEST(Trail, ArcRecedesWhereBothItsEndsDo) {
  const ArcPiece corner{3, 2, 2, 0, 2};
  const Discs behind = discs_at(-2, 0, 0.5);
  const auto test = [&](Vec3 to_tip) {
    return Trail(corner, {{0, 0, 0}, {0, 0, 1}}, {to_tip, {0, 0, 1}}, {}).behind(behind);
  };
  EXPECT_EQ(test({1, 0, 0}), 0xFFU);
  EXPECT_EQ(test({1, 0, 0.3}), 0xFFU);
  EXPECT_EQ(test({1, 0, -1e-8}), 0U);  // its lower border is level
  EXPECT_EQ(test({-1, 0, 0}), 0U);
}

TEST(Trail, OnlyThePartOfAnArcOverADiscCounts) {
  // The corner sinks while it moves sideways: its bottom advances, its outer part recedes.
  const ToolPose from{{0, 0, 0}, {0, 0, 1}}, to{{1, 0, -0.1}, {0, 0, 1}};
  const Trail trail(ArcPiece{3, 2, 2, 0, 2}, from, to, {});
  EXPECT_EQ(trail.behind(discs_at(-5, 0, 0.1)), 0xFFU);
  EXPECT_EQ(trail.behind(discs_at(-3.3, 0, 0.1)), 0U);
}

TEST(Trail, MotionAlongTheRaysHasNoTrail) {
  const ToolPose from{{0, 0, 0}, {1, 0, 0}}, to{{0, 0, 1}, {1, 0, 0}};
  const Trail trail(FrustumPiece{5, 4, 50, 4}, from, to, {});
  for (const double y : {-3.0, 0.0, 3.0}) EXPECT_EQ(trail.behind(discs_at(20, y, 0.5)), 0U);
}

TEST(Trail, DiscWithAxisAcrossTheRaysIsThin) {
  // The mill's bottom at x = 0 turns outwards at y < 0, where the side recedes.
  const auto mill = [](double lean) {
    const ToolPose from{{0, 0, 0}, normalized(Vec3{1, 0, lean})};
    const ToolPose to{{0, 1, 0}, normalized(Vec3{1, -0.02, lean})};
    return Trail(FrustumPiece{0, 4, 8, 4}, from, to, {true, false});
  };
  EXPECT_EQ(mill(0.001).behind(discs_at(2.5, -3, 0.5)), 0xFFU);
  EXPECT_EQ(mill(0.001).behind(discs_at(0.5, -3, 0.5)), 0U);
  // Rays within the plane of a disc at the first or the last pose need the full test.
  EXPECT_EQ(mill(0).behind(discs_at(2.5, -3, 0.5)), 0U);
}

TEST(Trail, FindsRegionsWhereOnlyAHiddenDiscAdvances) {
  const Discs behind = discs_at(-2.5, 1, 0.5);
  const ToolPose from{{0, 0, 0}, {0, 0, 1}}, up{{1, 0, 0.1}, {0, 0, 1}};
  const Trail hides_upper(FrustumPiece{0, 4, 50, 4}, from, up, {true, true}, {true, false});
  EXPECT_EQ(hides_upper.receding(behind).all, 0U);
  EXPECT_EQ(hides_upper.receding(behind).shown, 0xFFU);
  const Trail hides_lower(FrustumPiece{0, 4, 50, 4}, from, up, {true, true}, {false, true});
  EXPECT_EQ(hides_lower.receding(behind).shown, 0U);
}

/// Returns whether a tick of a tool sweeps rows of the block around (-2, -0.4). The tool moves by
/// 0.1 mm along x and leans by 15 degrees in the direction `azimuth`, at the end a quarter of a
/// degree further. The tip is 4 mm below the top of the grid, and the stock ends `stock_mm` above
/// the tip.
bool sweeps_behind(const ToolShape& shape, double azimuth, double stock_mm) {
  const Tool tool = *make_tool(shape);
  const auto pose = [](double x, double angle) {
    return ToolPose{{x, 0, -4}, {0.26 * std::cos(angle), 0.26 * std::sin(angle), 0.9656}};
  };
  const ToolPose from = pose(0, azimuth), to = pose(0.1, azimuth + 0.017);
  const DexelField field(BoxStock{{-6.4, -6.4, -8}, {6.4, 6.4, 0}}, 0.1);
  const DexelGrid& grid = field.grid();
  DexelTile tile;
  const auto top = std::int32_t((4 + stock_mm) / grid.z_quantum_mm);
  tile.bottom.fill(0);
  tile.top.fill(top);
  tile.block_top.fill(top);
  ColumnBlock block;
  bool sweeps = false;
  const SweepSettings settings{MotionModel::kTight, kToleranceMm, ray_bounds(grid), true};
  sweep_tool(tool,
             make_motion({from.tip_mm, normalized(from.axis)}, {to.tip_mm, normalized(to.axis)},
                         tool.length_mm),
             settings, [&](const SubMotion& part) {
               sweep_block(part.swept, grid, &tile, 40, 56, block);
               sweeps |= block.filled != 0;
             });
  return sweeps;
}

TEST(ToolReach, SkipsOnlyASingleRecedingPiece) {
  PieceBounds recedes, advances;
  recedes.reached = advances.reached = 0b1111;
  recedes.left_out.shown_behind = 0b0111;
  ToolReach tool;
  tool.add(recedes, recedes.reached);
  EXPECT_EQ(tool.discs(), 0b1000U);
  tool.add(recedes, 0b10010);  // near enough to close a gap over disc 1
  EXPECT_EQ(tool.discs(), 0b1010U);
  tool.add(advances, 0);
  EXPECT_EQ(tool.discs(), 0b1111U);
}

TEST(Trail, WholeToolRemovesNothingBehindIt) {
  // The bottom of a bull-nose that leans forwards rises, and so does its disc at the shank.
  const BullNoseShape bull_nose{6, 1, 30};
  EXPECT_FALSE(sweeps_behind(bull_nose, 0.7, 0.7));
  EXPECT_TRUE(sweeps_behind(bull_nose, 0.7 + 3.1, 0.7));  // leaning backwards, it sinks
  // A point of the axis rests within the barrel.
  const ProfileShape barrel{{ProfilePoint{2.5, 0}, ProfileArc{{2.5, 24}, 30}}};
  EXPECT_FALSE(sweeps_behind(barrel, 0.09, 0.6));
  EXPECT_TRUE(sweeps_behind(barrel, 0.09 + 3.1, 0.6));
}

struct Chain {
  const char* name;
  double step_mm, turn;
  double steep = 0.3;  ///< greatest share of the direction along z
};

/// Returns the greatest difference of the ends between two carvings: a chain of motions of one
/// tool, where each start is known to be cut, and the same motions by two tools of equal shape in
/// turn, where it is not.
double greatest_difference(const ToolShape& shape, const Chain& chain, std::uint64_t seed) {
  SculptureSettings settings{.stock = BoxStock{{-12, -12, -8}, {12, 12, 0}},
                             .rays = Rays::kTriDexel,
                             .pitch_mm = 0.4,
                             .tolerance_mm = kToleranceMm};
  auto one = *Sculpture::create(settings), two = *Sculpture::create(settings);
  for (const ToolId id : {1u, 2u}) {
    one.apply(DefineTool{id, *make_tool(shape)}).value();
    two.apply(DefineTool{id, *make_tool(shape)}).value();
  }
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto vec = [&](double z_share) {
    const double x = any(random), y = any(random);
    return Vec3{x, y, z_share * any(random)};
  };
  ToolPose last{vec(0) * 10 + Vec3{0, 0, -3 + 2 * any(random)},
                normalized(vec(0) * 0.4 + Vec3{0, 0, 1})};
  Vec3 direction = normalized(vec(chain.steep));
  for (ToolId i = 0; i < 10; ++i) {
    direction = normalized(direction + vec(chain.steep) * 0.3);
    const ToolPose next{last.tip_mm + direction * chain.step_mm,
                        chain.turn > 0 ? normalized(last.axis + vec(1) * chain.turn) : last.axis};
    one.apply(MoveTool{1, last, next, 0}).value();
    two.apply(MoveTool{1 + i % 2, last, next, 0}).value();
    last = next;
  }
  double worst = 0;
  std::vector<Dexel> a, b;
  for (const RayAxis axis : {RayAxis::kZ, RayAxis::kX, RayAxis::kY}) {
    const DexelSnapshot of_one = one.snapshot(axis), of_two = two.snapshot(axis);
    const DexelGrid& grid = of_one.grid();
    for (std::int32_t j = 0; j < grid.columns_y; ++j) {
      for (std::int32_t i = 0; i < grid.columns_x; ++i) {
        const auto first = of_one.column(i, j, a), second = of_two.column(i, j, b);
        if (first.size() != second.size()) return 1e9;
        for (std::size_t k = 0; k < first.size(); ++k) {
          const std::int32_t off = std::max(std::abs(first[k].bottom - second[k].bottom),
                                            std::abs(first[k].top - second[k].top));
          worst = std::max(worst, off * grid.z_quantum_mm);
        }
      }
    }
  }
  return worst;
}

TEST(Trail, SkippedRegionsWereAlreadyRemoved) {
  const std::vector<ToolShape> shapes{
      FlatShape{6, 30}, TaperShape{3, 12, 30}, BullNoseShape{6, 1, 30}, ConeEndShape{8, 90, 30},
      TaperShape{4, 8, 30, TaperTip::kBall},
      ProfileShape{
          {ProfilePoint{0, 0}, ProfilePoint{4, 0}, ProfilePoint{2, 4}, ProfilePoint{2, 30}}},
      ProfileShape{{ProfilePoint{0, 0}, ProfileArc{{1, 5.828}, 3}, ProfilePoint{1, 30}}},
      ProfileShape{{ProfilePoint{2, 0}, ProfileArc{{3, 12}, 40}}}, BullNoseShape{10, 0.5, 30},
      // Points enter these through the side of one piece and pass through a disc into the next.
      ProfileShape{
          {ProfilePoint{2, 0}, ProfilePoint{6, 4}, ProfilePoint{2, 8}, ProfilePoint{2, 30}}},
      ProfileShape{{ProfilePoint{1, 0}, ProfilePoint{4, 2}, ProfilePoint{2, 4}, ProfilePoint{5, 6},
                    ProfilePoint{1, 9}, ProfilePoint{3, 30}}},
      ProfileShape{{ProfilePoint{3, 0}, ProfileArc{{4, 1}, 1}, ProfileArc{{3, 2}, 1},
                    ProfilePoint{1.5, 2}, ProfilePoint{1.5, 30}}}};
  for (const Chain& chain : {Chain{"moves", 1, 0.04}, Chain{"ticks", 0.2, 0.004},
                             Chain{"blocks", 5, 0.3}, Chain{"translations", 1, 0},
                             Chain{"plunges", 0.5, 0, 3}, Chain{"tilted plunges", 0.5, 0.01, 3}}) {
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      for (std::uint64_t seed = 1; seed <= 2; ++seed) {
        EXPECT_LE(greatest_difference(shapes[k], chain, 10 * k + seed), kToleranceMm)
            << chain.name << " shape " << k << " seed " << seed;
      }
    }
  }
}

}  // namespace
}  // namespace kerf::trail_test
