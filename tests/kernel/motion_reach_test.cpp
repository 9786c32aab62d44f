// SPDX-License-Identifier: Apache-2.0
#include "kernel/motion_reach.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "kernel/dexel/dexel_field.h"
#include "kernel/sculpture.h"

namespace kerf {
namespace {

std::vector<DexelGrid> grids_of(const Sculpture& block) {
  std::vector<DexelGrid> grids;
  for (const RayAxis axis : {RayAxis::kZ, RayAxis::kX, RayAxis::kY}) {
    if (const DexelField* field = block.field(axis)) grids.push_back(field->grid());
  }
  return grids;
}

TEST(MotionReach, HoldsEveryTileThatAMotionCuts) {
  std::mt19937 random(8);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  SculptureSettings settings;
  settings.stock = BoxStock{{0, 0, -30}, {60, 50, 0}};
  settings.pitch_mm = 0.5;
  settings.tolerance_mm = 0.05;
  settings.rays = Rays::kTriDexel;
  settings.keep_normals = false;
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

TEST(MotionReach, ADiagonalReachesTilesInProportionToItsLength) {
  SculptureSettings settings;
  settings.stock = BoxStock{{0, 0, -10}, {1000, 1000, 0}};
  settings.pitch_mm = 0.1;
  settings.keep_normals = false;
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
}  // namespace kerf
