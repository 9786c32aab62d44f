// SPDX-License-Identifier: Apache-2.0
// The interval that a pose removes from a ray depends on the tool, the pose and the ray alone, to
// the last bit of the heights before they are rounded (kernel/sweep/README.md, "A pose").

#include "kernel/cut/swept_block.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/math/rotation.h"
#include "kernel/sculpture_motion.h"
#include "kernel/sweep/slice_meeting.h"
#include "kernel/sweep/swept_tool.h"
#include "tests/support/test.h"

namespace kerf::pose_test {
namespace {

constexpr int kSide = 2 * kBlockSide;  // columns of the grid, either direction

class Random {
 public:
  explicit Random(unsigned seed) : source_(seed) {}
  double in(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(source_);
  }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(source_); }
  Vec3 vec(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }

 private:
  std::mt19937_64 source_;
};

ToolShape any_shape(Random& random) {
  const double d = random.in(1, 8);
  switch (random.below(9)) {
    case 0:
      return BallShape{d, 30};
    case 1:
      return FlatShape{d, 30};
    case 2:
      return BullNoseShape{d, random.in(0.01, 0.499) * d, 30};
    case 3:
      return TaperShape{d, random.in(1, 30), 12, TaperTip::kFlat};
    case 4:
      return TaperShape{d, random.in(1, 30), 12, TaperTip::kBall};
    case 5:
      return ConeEndShape{d, random.in(20, 170), 30};
    case 6:
      return AptShape{d,
                      d * random.in(0.05, 0.3),
                      d * 0.2,
                      d * random.in(0.1, 0.4),
                      random.in(0, 20),
                      random.in(-5, 10),
                      12};
    case 7:
      return ProfileShape{{ProfilePoint{2, 0}, ProfileArc{{random.in(2, 3), 12}, 1000}}};
    default:
      return ProfileShape{
          {ProfilePoint{2, 0}, ProfileArc{{2, 4}, 2}, ProfilePoint{0.5, 4}, ProfilePoint{0.5, 12}}};
  }
}

/// The heights that a sweep removes from every ray of a grid of 16 by 16, before they are rounded.
using Heights = std::vector<std::pair<double, double>>;
struct Removed {
  Heights rays[kSide][kSide];

  void add(const DexelGrid& grid, const SweptTool& swept) {
    ColumnBlock block;
    for (int j = 0; j < kSide; j += kBlockSide) {
      for (int i = 0; i < kSide; i += kBlockSide) {
        sweep_block(swept, grid, nullptr, i, j, block);
        for (int row = 0; row < kBlockSide; ++row) {
          if ((block.filled >> row & 1) == 0) continue;
          keep(grid, block.lo_mm[row], block.hi_mm[row], rays[j + row] + i);
        }
        for (const ColumnBlock::Apart& a : block.apart) {
          keep(grid, a.lo_mm, a.hi_mm, rays[j + a.row] + i);
        }
      }
    }
  }

 private:
  static void keep(const DexelGrid& grid, const Lanes& lo, const Lanes& hi, Heights* of) {
    const double bottom = grid.origin_mm.z, top = grid.z_mm(grid.height_quanta);
    for (int lane = 0; lane < kLanes; ++lane) {
      // Ends beyond the grid are not compared.
      const double from = std::max(lo[lane], bottom);
      const double to = hi[lane] > top - 1e-9 ? top : hi[lane];
      if (from < to) of[lane].push_back({from, to});
    }
  }
};

/// Returns whether all of `asked` is in the union of `removed`.
bool covers(Heights removed, const Heights& asked) {
  std::ranges::sort(removed);
  return std::ranges::all_of(asked, [&](const auto& a) {
    double covered = a.first;
    for (const auto& [lo, hi] : removed) {
      if (lo <= covered) covered = std::max(covered, hi);
    }
    return covered >= a.second;
  });
}

/// Factor by which the tests are longer.
int effort() {
  const char* text = std::getenv("KERF_EFFORT");
  return text != nullptr ? std::max(1, std::atoi(text)) : 1;
}

ToolPose any_pose(Random& random) {
  const Vec3 axes[] = {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  const int kind = random.below(8);
  const Vec3 axis = kind < 4 ? axes[kind] : normalized(Vec3{0, 0, 0.7} + random.vec(1));
  const Vec3 below = axis * random.in(-6, 3);
  return {below + random.vec(2), axis};
}

ToolPose another(Random& random, const ToolPose& pose) {
  const double sizes[] = {1e-9, 1e-6, 1e-3, 0.1, 1, 4};
  Vec3 travel = random.vec(sizes[random.below(6)]);
  const int kind = random.below(8);
  if (kind == 0) travel = {};
  if (kind == 1) travel = pose.axis * travel.x;
  if (kind == 2) travel.z = 0;
  if (kind == 3) travel = cross(pose.axis, travel);
  const double turns[] = {0, 0, 1e-6, 1e-3, 0.05, 0.4};
  const Vec3 axis = normalized(pose.axis + random.vec(turns[random.below(6)]));
  return {pose.tip_mm + travel, kind == 0 || random.below(2) == 0 ? pose.axis : axis};
}

/// The heights that a frustum removes from one ray.
Span hit(const FrustumPiece& piece, const ToolPose& pose, double x, double y) {
  LaneSpan span;
  include_pose(span, ConeSide(piece), pose, Lanes(x), Lanes(y), 100);
  return {span.lo[0], span.hi[0]};
}
bool misses(const Span& s) { return s.lo > s.hi; }

TEST(Pose, UprightCylinderEndsAtItsDiscs) {
  const ToolPose pose{{0, 0, 2}, {0, 0, 1}};
  const Span s = hit({0, 5, 30, 5}, pose, 3, 3.9);
  EXPECT_DOUBLE_EQ(s.lo, 2);
  EXPECT_DOUBLE_EQ(s.hi, 32);
  EXPECT_TRUE(misses(hit({0, 5, 30, 5}, pose, 3, 4.1)));
}

TEST(Pose, UprightConeStartsOnItsSide) {
  const Span s = hit({0, 0, 10, 10}, {{0, 0, 0}, {0, 0, 1}}, 3, 4);
  EXPECT_DOUBLE_EQ(s.lo, 5);
  EXPECT_DOUBLE_EQ(s.hi, 10);
}

TEST(Pose, LyingCylinderIsHitAcross) {
  const Span s = hit({0, 5, 20, 5}, {{0, 0, 0}, {1, 0, 0}}, 7, 4);
  EXPECT_DOUBLE_EQ(s.lo, -3);
  EXPECT_DOUBLE_EQ(s.hi, 3);
}

TEST(Pose, RayParallelToAGeneratorStillEnters) {
  // Half angle 45 degrees, leaning by 45 degrees: the quadratic's leading coefficient is exactly
  // zero.
  const double h = std::sqrt(0.5);
  const Span s = hit({0, 0, 10, 10}, {{0, 0, 0}, {h, 0, h}}, 2, 1);
  ASSERT_FALSE(misses(s));
  // On the cone, (x + z)^2 / 2 = (z - x)^2 / 2 + y^2, so z = y^2 / (2 x).
  EXPECT_NEAR(s.lo, 1.0 / 4, 1e-12);
}

TEST(Pose, MotionContainsItsLastPoseToTheBit) {
  Random random(1);
  std::int64_t rays = 0;
  const int motions = 1500 * effort();
  for (int n = 0; n < motions; ++n) {
    const auto tool = make_tool(any_shape(random));
    if (!tool) continue;
    const double pitch = random.in(0.02, 0.3), size = kSide * pitch;
    const DexelField field(BoxStock{{-size / 2, -size / 2, -5}, {size / 2, size / 2, 3}}, pitch);
    const DexelGrid& grid = field.grid();
    const ToolPose pose = any_pose(random), other = another(random, pose);
    const MotionModel model = random.below(6) == 0 ? MotionModel::kPaper : MotionModel::kTight;
    const SweepSettings settings{model, random.below(2) == 0 ? 0.001 : 0.05, ray_bounds(grid)};
    const ToolMotion motion = make_motion(other, pose, tool->length_mm);
    if (count_sub_motions(*tool, motion, settings) > 2000) continue;
    Removed at_pose, along;
    sweep_tool(*tool, make_motion(motion.to, motion.to, tool->length_mm), settings,
               [&](const SubMotion& part) { at_pose.add(grid, part.swept); });
    sweep_tool(*tool, motion, settings,
               [&](const SubMotion& part) { along.add(grid, part.swept); });
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        if (at_pose.rays[j][i].empty()) continue;
        ++rays;
        ASSERT_TRUE(covers(along.rays[j][i], at_pose.rays[j][i]))
            << "motion " << n << ", ray " << i << " " << j;
      }
    }
  }
  EXPECT_GT(rays, 10'000);
  RecordProperty("rays", std::to_string(rays));
}

}  // namespace
}  // namespace kerf::pose_test
