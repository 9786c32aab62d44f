// SPDX-License-Identifier: Apache-2.0
// Compares the sweeps with the true motion, by an oracle that shares no code with them: random
// poses, every tool, both models.

#include "kernel/sculpture.h"
#include "tests/support/swept_oracle.h"
#include "tests/support/test.h"

namespace kerf::sweep_property_test {
namespace {

constexpr double kDepth = 20;

struct Case {
  std::string name;
  ToolShape shape;
};

std::vector<Case> tools() {
  return {{"ball", BallShape{10, 50}},
          {"flat", FlatShape{10, 50}},
          {"taper", TaperShape{4, 12, 40}},
          {"taper_ball", TaperShape{6, 8, 40, TaperTip::kBall}},
          {"cone_end", ConeEndShape{10, 90, 50}}};
}

class Poses {
 public:
  explicit Poses(unsigned seed) : random_(seed) {}
  double in(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
  ToolPose start() {
    const double lean = in(0, 0.9), azimuth = in(0, 6.28);
    return {
        {in(-2, 2), in(-2, 2), in(-8, -1)},
        {std::sin(lean) * std::cos(azimuth), std::sin(lean) * std::sin(azimuth), std::cos(lean)}};
  }
  ToolPose next(const ToolPose& a, double turn) {
    const Vec3 side = normalized(cross(a.axis, Vec3{in(-1, 1), in(-1, 1), in(-1, 1)}));
    return {a.tip_mm + Vec3{in(-2, 2), in(-2, 2), in(-1, 1)},
            normalized(a.axis * std::cos(turn) + side * std::sin(turn))};
  }

 private:
  std::mt19937 random_;
};

struct Removed {
  bool any = false;
  double lo = 0, hi = 0;
};

/// Returns the range that the kernel removed from a column (these sweeps leave no islands).
Removed removed_from(const DexelSnapshot& s, int i, int j) {
  std::vector<Dexel> scratch;
  Removed r;
  std::int32_t z = 0;
  const auto gap = [&](std::int32_t lo, std::int32_t hi) {
    if (lo >= hi) return;
    if (!r.any) r.lo = s.grid().z_mm(lo);
    r.hi = s.grid().z_mm(hi);
    r.any = true;
  };
  for (const Dexel& d : s.column(i, j, scratch)) {
    gap(z, d.bottom);
    z = d.top;
  }
  gap(z, s.grid().height_quanta);
  return r;
}

double outside_of(const Tool& tool, const ToolPose& a, const ToolPose& b, Vec3 p) {
  double best = 1e300;
  for (const ToolPiece& piece : tool.pieces) {
    best = std::min(best, test::swept_outside(piece, a, b, p, 150));
  }
  return best;
}

/// Returns the true range over all pieces, within the block.
Removed true_range(const Tool& tool, const ToolPose& a, const ToolPose& b, double x, double y) {
  Removed r{false, 1e300, -1e300};
  for (const ToolPiece& piece : tool.pieces) {
    const Span s = test::swept_span(piece, a, b, x, y, -kDepth - 1, 1, 40);
    if (!(s.lo < s.hi)) continue;
    r.lo = std::min(r.lo, std::max(s.lo, -kDepth));
    r.hi = std::max(r.hi, std::min(s.hi, 0.0));
  }
  r.any = r.lo < r.hi;
  return r;
}

/// Returns the distance between a removed end and the surface of the true sweep. It is computed
/// only if the ends differ along the ray by more than the tolerance, as they may on a steep wall.
double error_of(const Tool& tool, const ToolPose& a, const ToolPose& b, double x, double y,
                const Removed& removed, double tolerance) {
  const Removed truth = true_range(tool, a, b, x, y);
  if (!truth.any && !removed.any) return 0;
  if (truth.any && removed.any && std::abs(truth.lo - removed.lo) <= tolerance &&
      std::abs(truth.hi - removed.hi) <= tolerance) {
    return 0;
  }
  if (!removed.any) return -outside_of(tool, a, b, {x, y, (truth.lo + truth.hi) / 2});
  double worst = 0;
  for (const double z : {removed.lo, removed.hi}) {
    if (z > -kDepth + 1e-6 && z < -1e-6) {
      worst = std::max(worst, std::abs(outside_of(tool, a, b, {x, y, z})));
    }
  }
  return worst;
}

void check_motion(const Tool& tool, const ToolPose& a, const ToolPose& b, MotionModel model,
                  double tolerance, const std::string& what) {
  auto sculpture = *Sculpture::create({.stock = BoxStock{{-24, -24, -kDepth}, {24, 24, 0}},
                                       .pitch_mm = 1.3,
                                       .tolerance_mm = tolerance,
                                       .motion = model});
  ASSERT_TRUE(sculpture.apply(DefineTool{1, tool}));
  const auto moved = sculpture.apply(MoveTool{1, a, b, 0.01});
  ASSERT_TRUE(moved) << what << ": " << moved.error().reason;
  const DexelSnapshot s = sculpture.snapshot();
  const DexelGrid& g = s.grid();
  for (int j = 0; j < g.columns_y; ++j) {
    for (int i = 0; i < g.columns_x; ++i) {
      const double error =
          error_of(tool, a, b, g.x_mm(i), g.y_mm(j), removed_from(s, i, j), tolerance);
      EXPECT_LE(error, tolerance) << what << " column " << i << ' ' << j;
    }
  }
}

class TightModel : public testing::TestWithParam<int> {};

TEST_P(TightModel, StaysWithinToleranceForAnyMotion) {
  const Case c = tools()[std::size_t(GetParam())];
  const Tool tool = *make_tool(c.shape);
  for (unsigned seed = 0; seed < 6; ++seed) {
    Poses poses(seed * 31 + 7);
    const ToolPose a = poses.start();
    const double turn = seed % 3 == 0 ? poses.in(0.1, 0.6) : poses.in(0, 0.06);
    const ToolPose b = poses.next(a, turn);
    const double tolerance = seed % 2 == 0 ? 0.01 : 0.001;
    check_motion(tool, a, b, MotionModel::kTight, tolerance,
                 c.name + " seed " + std::to_string(seed));
  }
}

TEST_P(TightModel, TranslationIsExact) {
  const Case c = tools()[std::size_t(GetParam())];
  const Tool tool = *make_tool(c.shape);
  for (unsigned seed = 0; seed < 4; ++seed) {
    Poses poses(seed * 17 + 3);
    const ToolPose a = poses.start();
    ToolPose b = poses.next(a, 0);
    b.axis = a.axis;
    check_motion(tool, a, b, MotionModel::kTight, 1e-6, c.name + " seed " + std::to_string(seed));
  }
}

TEST_P(TightModel, TurnsAboutTheTipAndAboutAPointOfTheShaft) {
  const Case c = tools()[std::size_t(GetParam())];
  const Tool tool = *make_tool(c.shape);
  for (const double pivot : {0.0, 4.0, 15.0, 60.0}) {
    Poses poses(91);
    const ToolPose a = poses.start();
    ToolPose b = poses.next(a, 0.08);
    b.tip_mm = a.tip_mm + (a.axis - b.axis) * pivot;
    check_motion(tool, a, b, MotionModel::kTight, 0.005,
                 c.name + " pivot " + std::to_string(pivot));
  }
}

TEST_P(TightModel, NeedsTheSquareRootOfThePaperModelsSubMotions) {
  const Tool tool = *make_tool(tools()[std::size_t(GetParam())].shape);
  const ToolPose a{{0, 0, -4}, {0, 0, 1}};
  const ToolPose b{{1, 0, -4}, normalized({0.0436, 0, 1})};
  const auto parts = [&](MotionModel model, double tolerance) {
    auto sculpture = *Sculpture::create({.stock = BoxStock{{-24, -24, -kDepth}, {24, 24, 0}},
                                         .pitch_mm = 4,
                                         .tolerance_mm = tolerance,
                                         .motion = model});
    sculpture.apply(DefineTool{1, tool}).value();
    return double(sculpture.apply(MoveTool{1, a, b, 0.01}).value().sub_motions);
  };
  EXPECT_LT(parts(MotionModel::kTight, 1e-5) / parts(MotionModel::kTight, 1e-3), 15);
  EXPECT_GT(parts(MotionModel::kPaper, 1e-5) / parts(MotionModel::kPaper, 1e-3), 80);
}

INSTANTIATE_TEST_SUITE_P(EveryTool, TightModel, testing::Range(0, 5),
                         [](const auto& tool) { return tools()[std::size_t(tool.param)].name; });

TEST(PaperModel, StaysWithinToleranceWithMoreSubMotions) {
  for (const std::size_t which : {0u, 1u, 4u}) {
    const Case c = tools()[which];
    Poses poses(11);
    const ToolPose a = poses.start();
    const ToolPose b = poses.next(a, 0.05);
    check_motion(*make_tool(c.shape), a, b, MotionModel::kPaper, 0.02, c.name);
  }
}

TEST(Sweep, RampAtExactlyTheConeAngleCutsItsFullVolume) {
  // A 90 degree V-bit on a ramp of 45 degrees: a known failure of some simulators, which lose the
  // whole cut.
  const auto removed = [](double slope) {
    auto sculpture =
        *Sculpture::create({.stock = BoxStock{{-5, -5, -10}, {15, 5, 0}}, .pitch_mm = 0.05});
    sculpture.apply(DefineTool{1, *make_tool(ConeEndShape{8, 90, 30})}).value();
    const Vec3 up{0, 0, 1};
    return sculpture.apply(MoveTool{1, {{0, 0, 0}, up}, {{3, 0, -3 * slope}, up}, 0.01})
        .value()
        .removed_mm3;
  };
  // Swept volume: the cone at the end, π 3^3 / 3, and nothing in front of it, because the ramp is
  // parallel to the cone's generator.
  EXPECT_GT(removed(1), 20);
  EXPECT_NEAR(removed(1), removed(1.0001), 0.02);
  EXPECT_NEAR(removed(1), removed(0.9999), 0.02);
}

}  // namespace
}  // namespace kerf::sweep_property_test
