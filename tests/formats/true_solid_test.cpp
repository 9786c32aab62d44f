// SPDX-License-Identifier: Apache-2.0
#include "server/verify/true_solid.h"

#include "server/carve/surface_error.h"
#include "tests/support/standard_job.h"
#include "tests/support/swept_oracle.h"
#include "tests/support/test.h"

namespace kerf::true_solid_test {
namespace {

std::map<ToolId, SceneTool> tool_map(const ToolShape& shape) {
  return {{1, SceneTool{.shape = shape, .body = {}, .tool = make_tool(shape).value()}}};
}

const BoxStock kBlock{{0, 0, 0}, {40, 40, 20}};

TEST(ToolProfile, GivesTheDistanceFromABall) {
  const ToolProfile ball(*make_tool(BallShape{10, 30}));
  EXPECT_TRUE(ball.convex());
  EXPECT_NEAR(ball.nearest(0, -2).distance_mm, 2, 1e-12);
  EXPECT_NEAR(ball.nearest(3, 1).distance_mm, 0, 1e-12);
  EXPECT_NEAR(ball.nearest(4, 20).distance_mm, -1, 1e-12);
  EXPECT_NEAR(ball.nearest(8, 34).distance_mm, 5, 1e-12);
  // The joint of ball and shaft is no border inside: the depth is that of the shaft.
  EXPECT_NEAR(ball.nearest(4, 5.01).distance_mm, -1, 1e-12);
  EXPECT_NEAR(ball.nearest(9, 5).normal_radial, 1, 1e-12);
}

TEST(ToolProfile, HasNoBorderBetweenConeAndShaft) {
  const ToolProfile tool(*make_tool(ConeEndShape{10, 90, 30}));
  EXPECT_TRUE(tool.convex());
  EXPECT_NEAR(tool.nearest(0, 5).distance_mm, -5 * std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(tool.nearest(4.5, 6).distance_mm, -0.5, 1e-9);
  EXPECT_NEAR(tool.nearest(0, -1).distance_mm, 1, 1e-9);
}

TEST(ToolProfile, ToolWithAWaistIsNotConvex) {
  const auto tool =
      make_tool(std::vector<ToolPiece>{BallPiece{3, 3}, FrustumPiece{3, 1, 20, 1}}).value();
  const ToolProfile profile(tool);
  EXPECT_FALSE(profile.convex());
  EXPECT_NEAR(profile.nearest(1.5, 15).distance_mm, 0.5, 1e-9);
  EXPECT_NEAR(profile.nearest(0, 3).distance_mm, -3, 1e-9);
  EXPECT_NEAR(profile.nearest(2, 3).distance_mm, -1, 1e-9);
}

TEST(TrueSolid, GivesTheDistancesOfASlot) {
  const auto tools = tool_map(FlatShape{6, 30});
  const TrueSolid solid(kBlock, tools, {{1, {{-10, 20, 15}}, {{50, 20, 15}}, 1, 0, false}}, 8);
  const auto expect = [&](Vec3 p, double mm, bool cut) {
    const auto d = solid.distance(p);
    EXPECT_NEAR(d.mm, mm, 1e-5) << p.x << ' ' << p.y << ' ' << p.z;
    EXPECT_EQ(d.cut, cut);
  };
  expect({20, 20, 14}, 1, true);      // below the floor
  expect({20, 20, 15.5}, 0.5, true);  // in the air above it
  expect({20, 23.25, 17}, 0.25, true);
  expect({20, 22.9, 18}, 0.1, true);
  expect({20, 30, 19.5}, 0.5, false);  // below the untouched top
  expect({20, 30, 21}, 1, false);
  // In the air near the foot of the wall: the distance to the nearer of the two.
  expect({20, 22.8, 15.3}, 0.2, true);
}

TEST(TrueSolid, FindsTheRidgeOfTwoCutsFromOutside) {
  const auto tools = tool_map(BallShape{10, 30});
  const TrueSolid solid(kBlock, tools,
                        {{1, {{-10, 16, 15}}, {{50, 16, 15}}, 1, 0, false},
                         {1, {{-10, 24, 15}}, {{50, 24, 15}}, 1, 0, false}},
                        8);
  // The ridge is at y = 20, z = 20 - sqrt(25 - 16) = 17.
  EXPECT_NEAR(solid.distance({20, 20, 17.4}).mm, 0.4, 0.01);
  EXPECT_NEAR(solid.distance({20, 20, 16}).mm, std::sqrt(32.0) - 5, 1e-5);
}

TEST(TrueSolid, AgreesWithBruteForceForTurningMotions) {
  std::mt19937 random(7);
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * (double(random()) / 4294967296.0);
  };
  for (const ToolShape& shape : {ToolShape(BallShape{8, 25}), ToolShape(FlatShape{6, 25})}) {
    const auto tools = tool_map(shape);
    for (int k = 0; k < 20; ++k) {
      const ToolPose from{{uniform(10, 30), uniform(10, 30), uniform(5, 15)}, {0, 0, 1}};
      const ToolPose to{from.tip_mm + Vec3{uniform(-5, 5), uniform(-5, 5), uniform(-3, 3)},
                        normalized({uniform(-1, 1), uniform(-1, 1), 1})};
      const TrueSolid solid({BoxStock{{-99, -99, -99}, {99, 99, 99}}}, tools,
                            {{1, from, to, 1, 0, false}}, 50);
      for (int n = 0; n < 20; ++n) {
        const Vec3 p{uniform(5, 35), uniform(5, 35), uniform(0, 40)};
        double outside = 1e9;
        for (const ToolPiece& piece : tools.at(1).tool.pieces)
          outside = std::min(outside, test::swept_outside(piece, from, to, p));
        const auto d = solid.distance(p);
        if (outside <= 0) continue;
        // Near an edge the oracle's value is only a lower bound of the distance.
        EXPECT_GT(d.mm, outside - 1e-5);
        EXPECT_LT(d.mm, outside * std::sqrt(2.0) + 1e-5);
        EXPECT_TRUE(d.cut);
      }
    }
  }
}

TEST(SurfaceError, OfTheStandardJobMatchesTheFormula) {
  // A third of the path is enough: rows 0 to 16.
  std::vector<ToolPose> path = test::standard_path(false);
  path.resize(1733);
  std::vector<ProgramMotion> motions;
  SculptureSettings settings = test::standard_settings(0.5, 0.01);
  settings.keep_normals = true;  // the mesh needs them
  auto sculpture = *Sculpture::create(settings);
  const auto tools = tool_map(BallShape{10, 50});
  sculpture.apply(DefineTool{1, tools.at(1).tool}).value();
  for (std::size_t n = 1; n < path.size(); ++n) {
    motions.push_back({1, path[n - 1], path[n], 0.01, 0, false});
    sculpture.apply(MoveTool{1, path[n - 1], path[n], 0.01, false}).value();
  }
  const TrueSolid truth(sculpture.settings().stock, tools, motions, 4);
  const DistanceFigures error = measure_surface(sculpture.solid(), truth, 3000);
  EXPECT_GT(error.samples, 1000u);
  // surface_bench measures at most 0.0055 mm away from the borders. Here the steep sides of the
  // outermost rows count too, as far as one field of rays hits them. A chord of half a millimeter
  // has an error of 0.006 mm on the ball.
  EXPECT_GT(error.max_mm, 0.002);
  EXPECT_LT(error.max_mm, 0.15);
  EXPECT_GT(error.rms_mm, 0.0005);
  EXPECT_LT(error.rms_mm, 0.04);
  EXPECT_LE(error.p99_mm, error.max_mm);
}

TEST(SurfaceError, UntouchedBlockHasNoError) {
  auto sculpture = *Sculpture::create(test::standard_settings(2, 0.01));
  const TrueSolid truth(sculpture.settings().stock, tool_map(BallShape{10, 50}), {}, 4);
  EXPECT_EQ(measure_surface(sculpture.solid(), truth, 1000).samples, 0u);
}

}  // namespace
}  // namespace kerf::true_solid_test
