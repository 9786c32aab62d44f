// SPDX-License-Identifier: Apache-2.0
#include "kernel/motion_reach.h"

#include "kernel/dexel/dexel_field.h"
#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::motion_reach_test {
namespace {

std::vector<DexelGrid> grids_of(const Sculpture& block) {
  std::vector<DexelGrid> grids;
  for (const RayAxis axis : {RayAxis::kZ, RayAxis::kX, RayAxis::kY}) {
    if (const DexelField* field = block.field(axis)) grids.push_back(field->grid());
  }
  return grids;
}

TEST(MotionReach, ContainsEveryTileThatAMotionCuts) {
  std::mt19937 random(8);
  const test::Uniform uniform(random);
  SculptureSettings settings{.stock = BoxStock{{0, 0, -30}, {60, 50, 0}},
                             .rays = Rays::kTriDexel,
                             .pitch_mm = 0.5,
                             .tolerance_mm = 0.05,
                             .keep_normals = false};
  const Tool tools[] = {
      *make_tool(BallShape{.diameter_mm = 6, .length_mm = 20}),
      *make_tool(FlatShape{.diameter_mm = 9, .length_mm = 25}),
      *make_tool(ConeEndShape{.diameter_mm = 6, .tip_angle_deg = 90, .length_mm = 30})};
  std::size_t cut = 0, reached = 0;
  std::vector<FieldTile> tiles;
  for (int n = 0; n < 120; ++n) {
    Sculpture block = Sculpture::create(settings).value();
    const Tool& tool = tools[std::size_t(n) % std::size(tools)];
    block.apply(DefineTool{1, tool}).value();
    const auto pose = [&] {
      return ToolPose{{uniform(-5, 65), uniform(-5, 55), uniform(-20, 3)},
                      normalized({uniform(-1, 1), uniform(-1, 1), uniform(0.2, 1)})};
    };
    MoveTool move{1, pose(), pose(), 1, false};
    if (n % 3 == 0) move.to.axis = move.from.axis;
    const MotionResult result = block.apply(move).value();
    find_reach(tool, move, grids_of(block), settings.tolerance_mm, tiles);
    ASSERT_TRUE(std::ranges::is_sorted(tiles));
    for (const FieldTile& at : result.cut_tiles) {
      ASSERT_TRUE(std::ranges::binary_search(tiles, at)) << "motion " << n;
    }
    auto distinct = result.cut_tiles;
    std::ranges::sort(distinct);
    distinct.erase(std::ranges::unique(distinct).begin(), distinct.end());
    cut += distinct.size();
    reached += tiles.size();
  }
  EXPECT_GT(cut, 1000U);
  EXPECT_LT(reached, 4 * cut);
}

bool meets_box(const Bounds& a, const Bounds& b) {
  const Vec3 lo = a.lo_mm - b.hi_mm, hi = b.lo_mm - a.hi_mm;
  return lo.x <= 0 && lo.y <= 0 && lo.z <= 0 && hi.x <= 0 && hi.y <= 0 && hi.z <= 0;
}

/// Calls `visit` with points on the cutting part at poses along a motion.
template <class Visit>
void for_each_point(const Tool& tool, const ToolMotion& motion, const Visit& visit) {
  constexpr int kPoses = 16, kHeights = 12, kAngles = 48;
  for (int pose = 0; pose <= kPoses; ++pose) {
    const ToolPose at = motion.at(double(pose) / kPoses);
    const Vec3 aside =
        normalized(cross(at.axis, std::abs(at.axis.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    const Vec3 third = cross(at.axis, aside);
    for (const ToolPiece& piece : tool.pieces) {
      const Extent e = extent(piece);
      for (int h = 0; h <= kHeights; ++h) {
        const double z = e.z0_mm + (e.z1_mm - e.z0_mm) * h / kHeights;
        const double radius = std::max(0.0, radius_at(piece, z));
        for (int n = 0; n < kAngles; ++n) {
          const double angle = 2 * 3.14159265358979 * n / kAngles;
          visit(at.tip_mm + at.axis * z +
                (aside * std::cos(angle) + third * std::sin(angle)) * radius);
        }
      }
    }
  }
}

TEST(MotionReach, BoxTightlyEnclosesTheSweptVolume) {
  std::mt19937 random(3);
  const test::Uniform uniform(random);
  std::vector<ProfilePoint> steps{{0, 0}};
  for (int n = 1; n < 20; ++n) steps.push_back({1.0 + n % 2 + 0.1 * n, 1.0 * n});
  const Tool tools[] = {
      *make_tool(BallShape{.diameter_mm = 6, .length_mm = 20}),
      *make_tool(FlatShape{.diameter_mm = 9, .length_mm = 25}),
      *make_tool(BullNoseShape{.diameter_mm = 10, .corner_radius_mm = 3, .length_mm = 20}),
      *make_tool(ConeEndShape{.diameter_mm = 6, .tip_angle_deg = 90, .length_mm = 30}),
      *make_tool(AptShape{12, 21, -15, 10, 0, 0, 20}),
      *make_tool(ProfileShape{{steps.begin(), steps.end()}})};
  for (int n = 0; n < 300; ++n) {
    const Tool& tool = tools[std::size_t(n) % std::size(tools)];
    const bool turns_little = n % 2 == 0;
    const Vec3 first = normalized({uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)});
    const Vec3 turn =
        Vec3{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)} * (turns_little ? 0.05 : 1.4);
    const ToolPose from{{uniform(-9, 9), uniform(-9, 9), uniform(-9, 9)}, first};
    const ToolPose to{from.tip_mm + Vec3{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)},
                      normalized(first + turn)};
    const ToolMotion motion = make_motion(from, n % 5 == 0 ? from : to, tool.length_mm);
    const Bounds box = reach_of(tool, motion);
    Bounds seen{from.tip_mm, from.tip_mm};
    std::size_t points = 0;
    for_each_point(tool, motion, [&](Vec3 p) {
      seen = joined(seen, {p, p});
      if (points++ % 61 != 0) return;
      EXPECT_TRUE(may_meet(tool, motion, grown({p, p}, 1e-9))) << "motion " << n;
    });
    constexpr double kRoundingMm = 1e-9;
    const Vec3 below = seen.lo_mm - box.lo_mm, above = box.hi_mm - seen.hi_mm;
    for (const double gap : {below.x, below.y, below.z, above.x, above.y, above.z}) {
      EXPECT_GE(gap, -kRoundingMm) << "motion " << n;
      if (turns_little && std::size_t(n) % std::size(tools) < 4) {
        EXPECT_LE(gap, 0.3) << "motion " << n;
      }
    }
  }
}

TEST(MotionReach, RoundToolMissesTheCornersOfItsBox) {
  const Tool ball = *make_tool(BallShape{.diameter_mm = 10, .length_mm = 40});
  const Tool flat = *make_tool(FlatShape{.diameter_mm = 10, .length_mm = 40});
  const Vec3 lean = normalized({0.2, 0, 1});
  const ToolMotion upright = make_motion({{0, 0, -4}, {0, 0, 1}}, {{0.2, 0, -4}, {0, 0, 1}}, 40);
  const ToolMotion tilted = make_motion({{0, 0, -4}, lean}, {{0.2, 0, -4}, lean}, 40);
  const auto box = [](Vec3 low, double side) { return Bounds{low, low + Vec3{side, side, side}}; };
  const Bounds under = box({3, 3, -4}, 0.4), aside = box({-5, -5, -2}, 1);
  const Bounds left = box({-5, -0.5, -0.5}, 0.4);
  for (const Bounds& each : {under, aside}) {
    EXPECT_TRUE(meets_box(reach_of(ball, upright), each));
    EXPECT_FALSE(may_meet(ball, upright, each));
  }
  EXPECT_TRUE(may_meet(flat, upright, under)) << "its bottom is level";
  EXPECT_FALSE(may_meet(flat, upright, aside));
  EXPECT_TRUE(may_meet(flat, upright, left));
  // It leans away: near the top of the block its axis is further right.
  const Bounds high = box({-5, -0.5, 4}, 0.4);
  EXPECT_TRUE(meets_box(reach_of(flat, tilted), high));
  EXPECT_FALSE(may_meet(flat, tilted, high));
  EXPECT_FALSE(may_meet(flat, upright, box({0, 0, -5}, 0.9))) << "below its bottom";
}

TEST(MotionReach, BoxContainsTheMiddleOfATurn) {
  // A needle passes the vertical, and a disc the horizontal, in the middle of the turn only.
  const Tool needle = *make_tool(FlatShape{.diameter_mm = 0.01, .length_mm = 20});
  const double half = std::sqrt(0.5);
  const Bounds over = reach_of(
      needle, make_motion({{}, {half, 0, half}}, {{}, {-half, 0, half}}, needle.length_mm));
  EXPECT_GE(over.hi_mm.z, 20);
  EXPECT_LE(over.hi_mm.z, 21);
  const Tool disc = *make_tool(FlatShape{.diameter_mm = 10, .length_mm = 0.1});
  const double most = std::sqrt(0.75);
  const Bounds through =
      reach_of(disc, make_motion({{}, {most, 0, 0.5}}, {{}, {most, 0, -0.5}}, disc.length_mm));
  EXPECT_LE(through.lo_mm.z, -5);
  EXPECT_GE(through.lo_mm.z, -5.1);
}

TEST(MotionReach, DiagonalReachesTilesInProportionToItsLength) {
  SculptureSettings settings{
      .stock = BoxStock{{0, 0, -10}, {1000, 1000, 0}}, .pitch_mm = 0.1, .keep_normals = false};
  const Sculpture block = Sculpture::create(settings).value();
  const Tool tool = *make_tool(BallShape{.diameter_mm = 3, .length_mm = 20});
  const Vec3 up{0, 0, 1};
  std::vector<FieldTile> tiles;
  const auto diagonal = [&](double z) {
    return MoveTool{1, {{1, 1, z}, up}, {{999, 999, z}, up}, 1, false};
  };
  find_reach(tool, diagonal(-1), grids_of(block), settings.tolerance_mm, tiles);
  EXPECT_GT(tiles.size(), 312U);
  EXPECT_LT(tiles.size(), 3000U);
  find_reach(tool, diagonal(0.5), grids_of(block), settings.tolerance_mm, tiles);
  EXPECT_TRUE(tiles.empty());  // above the stock
}

}  // namespace
}  // namespace kerf::motion_reach_test
