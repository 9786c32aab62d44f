// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/lazy_normals.h"
#include "kernel/dexel/normal_code.h"
#include "kernel/math/rotation.h"
#include "tests/kernel/extremes/carving.h"
#include "tests/kernel/extremes/true_sweep.h"
#include "tests/support/test.h"

namespace kerf::end_normals_test {
namespace {

using test::TrueSweep;

class Numbers {
 public:
  explicit Numbers(unsigned seed) : random_(seed) {}
  double in(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }
  Vec3 vec(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }

 private:
  std::mt19937 random_;
};

TEST(NormalCode, RoundTripsDirectionsAndAxesExactly) {
  Numbers numbers(3);
  double worst = 0;
  for (int n = 0; n < 20000; ++n) {
    const Vec3 unit = normalized(numbers.vec(1));
    const NormalCode code = encode_normal(unit);
    EXPECT_NE(code, kStockNormal);
    worst = std::max(worst, length(decode_normal(code) - unit));
  }
  EXPECT_LT(worst, 0.004 * std::numbers::pi / 180);
  for (const Vec3 axis : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
    EXPECT_EQ(decode_normal(encode_normal(axis)), axis);
    EXPECT_EQ(decode_normal(encode_normal(-axis)), -axis);
  }
}

/// Counts the ends that a motion made, in all fields, and those whose normal contradicts the true
/// sweep: a step along the normal must leave the sweep, a step against it must enter it, and a step
/// across it must follow the surface.
struct Judged {
  int ends = 0, wrong = 0;
};

void judge_end(Vec3 at, Vec3 out_of_sweep, const TrueSweep& sweep, Judged& judged) {
  constexpr double kStepMm = 0.01, kAllowanceMm = 0.03 * kStepMm;
  ++judged.ends;
  const auto outside = [&](Vec3 step) { return sweep.outside(at + step * kStepMm, 1); };
  const Vec3 a = any_perpendicular(out_of_sweep), b = cross(out_of_sweep, a);
  bool right = outside(out_of_sweep) > 0.2 * kStepMm && outside(-out_of_sweep) < -0.2 * kStepMm;
  for (const Vec3 along : {a, -a, b, -b}) right &= std::abs(outside(along)) < kAllowanceMm;
  judged.wrong += right ? 0 : 1;
}

void judge_field(const DexelSnapshot& snapshot, const TrueSweep& sweep, Judged& judged) {
  const DexelGrid& grid = snapshot.grid();
  for (std::int32_t j = 0; j < grid.columns_y; ++j) {
    for (std::int32_t i = 0; i < grid.columns_x; ++i) {
      const ColumnView view = snapshot.view(i, j);
      const auto judge = [&](Dexel element, EndCodes codes) {
        const Vec3 foot{grid.x_mm(i), grid.y_mm(j), 0};
        const auto world = [&](Vec3 v) { return from_frame(grid.axis, v); };
        if (codes.bottom != kStockNormal) {
          judge_end(world(foot + Vec3{0, 0, grid.z_mm(element.bottom)}),
                    -world(decode_normal(codes.bottom)), sweep, judged);
        }
        if (codes.top != kStockNormal) {
          judge_end(world(foot + Vec3{0, 0, grid.z_mm(element.top)}),
                    -world(decode_normal(codes.top)), sweep, judged);
        }
      };
      for (std::size_t n = 0; n < view.lower.size(); ++n) {
        judge(view.lower[n], view.lower_codes[n]);
      }
      if (view.topmost.bottom < view.topmost.top) judge(view.topmost, view.topmost_codes);
    }
  }
}

ToolPose any_pose(Numbers& numbers) {
  return {numbers.vec(6) - Vec3{0, 0, 3}, normalized(numbers.vec(1) + Vec3{0, 0, 1.2})};
}

/// Returns the codes of every end of a block after 300 random motions, with a snapshot taken
/// periodically.
std::vector<NormalCode> codes_looked_at_every(int motions) {
  SculptureSettings settings = test::block(20, 12, 0.7, 1e-3);
  settings.rays = Rays::kTriDexel;
  auto sculpture = Sculpture::create(settings).value();
  EXPECT_TRUE(sculpture.apply(DefineTool{1, *make_tool(FlatShape{4, 20})}));
  Numbers numbers(5);
  ToolPose at = any_pose(numbers);
  for (int n = 1; n <= 700; ++n) {
    ToolPose next{at.tip_mm + numbers.vec(0.4), normalized(at.axis + numbers.vec(0.02))};
    if (n % 40 == 0) {
      next = any_pose(numbers);
    } else {
      EXPECT_TRUE(sculpture.apply(MoveTool{1, at, next, 0}));
    }
    if (n % motions == 0) sculpture.solid();
    at = next;
  }
  std::vector<NormalCode> codes;
  for (const DexelSnapshot& field : sculpture.solid().fields) {
    for (std::int32_t j = 0; j < field.grid().columns_y; ++j) {
      for (std::int32_t i = 0; i < field.grid().columns_x; ++i) {
        const ColumnView view = field.view(i, j);
        for (const EndCodes& c : view.lower_codes) codes.insert(codes.end(), {c.bottom, c.top});
        if (view.topmost.bottom == view.topmost.top) continue;
        codes.insert(codes.end(), {view.topmost_codes.bottom, view.topmost_codes.top});
      }
    }
  }
  return codes;
}

// Regression: the side of a mill approaches fast and its disc recedes slowly, and a search by the
// speed alone took too many steps to reach the share at which one follows the other.
TEST(EndNormals, PointUpOnTheFloorOfAnInclinedSlot) {
  for (const double rise : {0.0, 0.3, -0.3, 1.0, -1.0}) {
    auto sculpture = Sculpture::create(test::block(60, 20, 0.5, 0.005)).value();
    ASSERT_TRUE(sculpture.apply(DefineTool{1, *make_tool(FlatShape{6, 40})}));
    const ToolPose from{{-12, 0.13, -4}, {0, 0, 1}}, to{{12, 3.2, -4 + rise}, {0, 0, 1}};
    ASSERT_TRUE(sculpture.apply(MoveTool{1, from, to, 0}));
    const DexelSnapshot field = sculpture.snapshot();
    int floor = 0, upright = 0;
    for (std::int32_t j = 0; j < field.grid().columns_y; ++j) {
      for (std::int32_t i = 0; i < field.grid().columns_x; ++i) {
        const ColumnView view = field.view(i, j);
        if (view.topmost_codes.top == kStockNormal) continue;
        ++floor;
        upright += decode_normal(view.topmost_codes.top).z > 0.7 ? 1 : 0;
      }
    }
    EXPECT_GT(floor, 600);
    EXPECT_GE(upright, floor - 5) << "rise " << rise;
  }
}

TEST(EndNormals, DoNotDependOnWhenTheyAreResolved) {
  const std::vector<NormalCode> at_once = codes_looked_at_every(1);
  EXPECT_GT(std::ranges::count_if(at_once, [](NormalCode c) { return c > 0xffff; }), 1000);
  EXPECT_EQ(std::ranges::count_if(at_once, [](NormalCode c) { return c - 1 < 0xffff; }), 0);
  EXPECT_EQ(codes_looked_at_every(7), at_once);
  EXPECT_EQ(codes_looked_at_every(1000), at_once);
}

TEST(EndNormals, MatchTheTrueSweepForEveryToolAndMotion) {
  Numbers numbers(11);
  for (const test::NamedTool& named : test::every_tool()) {
    Judged judged;
    for (int n = 0; n < 4 * test::effort(); ++n) {
      SculptureSettings settings = test::block(20, 12, 1.1, 1e-4);
      settings.rays = Rays::kTriDexel;
      auto sculpture = Sculpture::create(settings).value();
      ASSERT_TRUE(sculpture.apply(DefineTool{1, named.tool}));
      const ToolPose from = any_pose(numbers);
      ToolPose to = any_pose(numbers);
      if (n % 4 == 0) to.axis = from.axis;
      if (n % 4 == 1) to = from;
      if (n % 4 == 2) to.axis = normalized(from.axis + numbers.vec(0.1));
      ASSERT_TRUE(sculpture.apply(MoveTool{1, from, to, 1, false}));
      const TrueSweep sweep(named.tool, from, to);
      for (const DexelSnapshot& field : sculpture.solid().fields) {
        judge_field(field, sweep, judged);
      }
    }
    EXPECT_GT(judged.ends, 100) << named.name;
    // Near an edge of the tool a step passes beyond the edge.
    EXPECT_LT(judged.wrong, 0.02 * judged.ends) << named.name << " " << judged.ends;
  }
}

}  // namespace
}  // namespace kerf::end_normals_test
