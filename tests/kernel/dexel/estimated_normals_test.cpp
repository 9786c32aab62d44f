// SPDX-License-Identifier: Apache-2.0
// Normals of stock that another copy of the block has cut are estimated from depths alone.
#include "kernel/dexel/dexel_field.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::estimated_normals_test {
namespace {

constexpr double kPitchMm = 0.25;
constexpr Vec3 kCenterMm{4, 4, 1};
constexpr double kRadiusMm = 3;

Sculpture block() {
  SculptureSettings settings;
  settings.stock = BoxStock{{0, 0, -10}, {8, 8, 0}};  // one tile
  settings.pitch_mm = kPitchMm;
  auto made = *Sculpture::create(settings);
  made.apply(DefineTool{1, *make_tool(BallShape{2 * kRadiusMm, 40})}).value();
  return made;
}

/// Returns a copy with the cuts of another block, as depths.
Sculpture copy_of(Sculpture& other) {
  const DexelTile& cut = *other.field(RayAxis::kZ)->find({0, 0});
  TileColumns columns;
  std::vector<Dexel> column;
  for (int place = 0; place < kTileColumns; ++place) {
    cut.read(place, column);
    columns.add(place, column);
  }
  Sculpture copy = block();
  copy.keep_common({RayAxis::kZ, {0, 0}}, columns);
  return copy;
}

TEST(EstimatedNormals, MatchABowlToAFewDegrees) {
  Sculpture server = block();
  const Vec3 tip = kCenterMm - Vec3{0, 0, kRadiusMm};
  server.apply(MoveTool{1, {tip, {0, 0, 1}}, {tip, {0, 0, 1}}}).value();
  Sculpture copy = copy_of(server);
  ASSERT_EQ(copy.state_hash(), server.state_hash());
  const DexelSnapshot seen = copy.snapshot();
  const DexelGrid& grid = seen.grid();
  int checked = 0;
  for (int i = 0; i < grid.columns_x; ++i) {
    for (int j = 0; j < grid.columns_y; ++j) {
      const double x = grid.x_mm(i) - kCenterMm.x, y = grid.y_mm(j) - kCenterMm.y;
      const ColumnView view = seen.view(i, j);
      const Vec3 normal = seen.normal(i, j, view.topmost.top, true, view.topmost_codes.top);
      const double from_axis = std::hypot(x, y);
      if (from_axis > 3) {  // outside the bowl
        EXPECT_EQ(normal, (Vec3{0, 0, 1}));
      } else if (from_axis < 2) {  // the rim is at 2.83 mm
        const Vec3 exact =
            normalized(kCenterMm - Vec3{grid.x_mm(i), grid.y_mm(j), grid.z_mm(view.topmost.top)});
        EXPECT_GT(dot(normal, exact), std::cos(2 * std::numbers::pi / 180));
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 150);
}

TEST(EstimatedNormals, LeaveWallsAndOwnCutsUnchanged) {
  Sculpture server = block();
  server.apply(DefineTool{2, *make_tool(FlatShape{4, 40})}).value();
  server.apply(MoveTool{2, {{4, 4, -5}, {0, 0, 1}}, {{4, 4, -5}, {0, 0, 1}}}).value();
  Sculpture copy = copy_of(server);
  const auto normal_at = [](Sculpture& block, int i, int j) {
    const DexelSnapshot seen = block.snapshot();
    const ColumnView view = seen.view(i, j);
    return seen.normal(i, j, view.topmost.top, true, view.topmost_codes.top);
  };
  // The floor is level up to the wall, which is farther away than the estimate reaches.
  for (int i = 9; i < 23; ++i) EXPECT_EQ(normal_at(copy, i, 16), (Vec3{0, 0, 1})) << i;
  // Own cuts have the normals of the tool.
  for (Sculpture* block : {&server, &copy}) {
    block->apply(MoveTool{1, {{4, 4, -6}, {0, 0, 1}}, {{4, 4, -6}, {0, 0, 1}}}).value();
  }
  EXPECT_EQ(normal_at(copy, 14, 15), normal_at(server, 14, 15));
  EXPECT_NE(normal_at(copy, 14, 15), (Vec3{0, 0, 1}));
}

}  // namespace
}  // namespace kerf::estimated_normals_test
