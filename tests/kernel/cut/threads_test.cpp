// SPDX-License-Identifier: Apache-2.0
// Long motions on several threads give the same bytes as on one.

#include "kernel/sculpture.h"
#include "tests/support/test.h"
#include "tests/support/thread_workers.h"

namespace kerf::threads_test {
namespace {

const Vec3 kUp{0, 0, 1};

Sculpture block(const StockShape& stock, Rays rays, const ToolShape& shape) {
  auto s = *Sculpture::create(
      {.stock = stock, .rays = rays, .pitch_mm = 0.25, .force = {.pivot_mm = 40}});
  s.apply(DefineTool{1, *make_tool(shape)}).value();
  return s;
}

/// Motions across the block and back, crossing earlier cuts: horizontal, plunging and turning, some
/// of them outside the block and through its border.
std::vector<ToolPose> long_path() {
  return {{{-3, 10, 15}, kUp},
          {{73, 25, 15}, kUp},
          {{73, 60, 11}, normalized({0.3, 0.1, 1})},
          {{-5, 5, 14}, normalized({-0.2, 0.2, 1})},
          {{70, 66, 8}, normalized({-0.2, 0.2, 1})},
          {{2, 68, 8}, kUp},
          {{2, 2, 13}, kUp}};
}

void expect_same(const MotionResult& a, const MotionResult& b) {
  EXPECT_EQ(a.wrench, b.wrench);
  EXPECT_EQ(a.cutting.engaged_area_mm2, b.cutting.engaged_area_mm2);
  EXPECT_EQ(a.cutting.center_mm, b.cutting.center_mm);
  EXPECT_EQ(a.removed_mm3, b.removed_mm3);
  EXPECT_EQ(a.changed_tiles, b.changed_tiles);
}

TEST(Threads, LongMotionsGiveTheSameBytesOnAnyNumberOfThreads) {
  for (const StockShape& stock : {StockShape{BoxStock{{0, 0, 0}, {70, 70, 20}}},
                                  StockShape{CylinderStock{35, 35, 34, 0, 20}}}) {
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      for (const ToolShape& shape : {ToolShape{BallShape{10, 40}}, ToolShape{FlatShape{8, 40}}}) {
        SCOPED_TRACE(std::string(to_string(rays)) + ' ' + std::to_string(stock.index()) + ' ' +
                     std::to_string(shape.index()));
        Sculpture alone = block(stock, rays, shape);
        Sculpture two = block(stock, rays, shape), five = block(stock, rays, shape);
        test::ThreadWorkers pair(2), many(5);
        const std::vector<ToolPose> path = long_path();
        for (std::size_t i = 1; i < path.size(); ++i) {
          const MoveTool move{1, path[i - 1], path[i], 0.5};
          const MotionResult expected = alone.apply(move).value();
          expect_same(two.apply(move, pair).value(), expected);
          expect_same(five.apply(move, many).value(), expected);
          // Some snapshots, after which tiles are copied instead of edited in place.
          const DexelSnapshot before = five.snapshot();
          ASSERT_EQ(five.state_hash(), alone.state_hash());
          EXPECT_EQ(before.hash(), alone.snapshot().hash());
        }
        EXPECT_EQ(two.state_hash(), alone.state_hash());
        EXPECT_GE(pair.runs(), 4);
        EXPECT_GE(many.runs(), 4);
      }
    }
  }
}

TEST(Threads, SnapshotIsImmutableWhileThreadsCarve) {
  Sculpture s = block(BoxStock{{0, 0, 0}, {70, 70, 20}}, Rays::kTriDexel, BallShape{10, 40});
  test::ThreadWorkers many(4);
  const std::vector<ToolPose> path = long_path();
  s.apply(MoveTool{1, path[0], path[1], 0.5}, many).value();
  const SolidSnapshot before = s.solid();
  const std::uint64_t hash = before.hash();
  for (std::size_t i = 2; i < path.size(); ++i) {
    s.apply(MoveTool{1, path[i - 1], path[i], 0.5}, many).value();
  }
  EXPECT_EQ(before.hash(), hash);
  EXPECT_NE(s.state_hash(), hash);
}

TEST(Threads, ShortMotionRunsOnTheCallingThread) {
  Sculpture s = block(BoxStock{{0, 0, 0}, {70, 70, 20}}, Rays::kTriDexel, BallShape{6, 40});
  test::ThreadWorkers many(4);
  for (int i = 0; i < 40; ++i) {
    const double x = 10 + 0.5 * i;
    s.apply(MoveTool{1, {{x, 30, 17}, kUp}, {{x + 0.5, 30, 17}, kUp}, 0.001}, many).value();
  }
  EXPECT_GT(s.removed_volume_mm3(), 10);
  EXPECT_EQ(many.runs(), 0);
}

}  // namespace
}  // namespace kerf::threads_test
