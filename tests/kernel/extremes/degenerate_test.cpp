// SPDX-License-Identifier: Apache-2.0
// Motions and poses at which a formula divides by zero, two surfaces coincide, or a case
// distinction has no case. Each is compared with an exact value or with the true sweep.

#include "tests/kernel/extremes/carving.h"
#include "tests/support/test.h"

namespace kerf::test::degenerate_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Vec3 kUp{0, 0, 1};

SculptureSettings small_block(double tolerance_mm = 1e-3) {
  return block(30, 16, 0.7, tolerance_mm);
}

double volume_taken(const SculptureSettings& settings, const Tool& tool, const ToolPose& from,
                    const ToolPose& to) {
  Carving carving(settings, tool);
  return carving.move(from, to).removed_mm3;
}

TEST(Degenerate, ZeroMoveCutsTheStandingTool) {
  for (const NamedTool& t : every_tool()) {
    for (const double lean : {0.0, 0.4, 1.3, kPi / 2, 2.5}) {
      Carving carving(small_block(), t.tool);
      const ToolPose pose = leaning({0.123, -0.217, -4.1}, lean, 0.7);
      EXPECT_GT(carving.move(pose, pose).removed_mm3, 0) << t.name << " lean " << lean;
      carving.expect_within_tolerance(t.name + " lean " + std::to_string(lean));
      EXPECT_EQ(carving.move(pose, pose).removed_mm3, 0) << t.name;
    }
  }
}

TEST(Degenerate, PlungeCutsTheShapeOfTheTool) {
  for (const NamedTool& t : every_tool()) {
    Carving carving(small_block(), t.tool);
    carving.move({{0, 0, 3}, kUp}, {{0, 0, -7}, kUp});
    carving.expect_within_tolerance(t.name);
    EXPECT_EQ(carving.move({{0, 0, -7}, kUp}, {{0, 0, 3}, kUp}).removed_mm3, 0)
        << t.name << ": retracting cuts nothing";
  }
  SculptureSettings fine = block(12, 16, 0.02, 1e-3);
  const double flat =
      volume_taken(fine, *make_tool(FlatShape{10, 50}), {{0, 0, 3}, kUp}, {{0, 0, -7}, kUp});
  EXPECT_NEAR(flat / (kPi * 25 * 7), 1, 2e-4);
  const double ball =
      volume_taken(fine, *make_tool(BallShape{10, 50}), {{0, 0, 3}, kUp}, {{0, 0, -7}, kUp});
  EXPECT_NEAR(ball / (kPi * 25 * 2 + 2 * kPi * 125 / 3), 1, 2e-4);
}

TEST(Degenerate, UpwardMoveFromWithinCutsItsStart) {
  for (const NamedTool& t : every_tool()) {
    Carving carving(small_block(), t.tool);
    carving.move({{0, 0, -7}, kUp}, {{0, 0, -2}, kUp});
    carving.expect_within_tolerance(t.name);
  }
}

TEST(Degenerate, TurnAboutTheTip) {
  for (const NamedTool& t : every_tool()) {
    for (const double turn : {0.02, 0.5, 1.5}) {
      Carving carving(small_block(), t.tool);
      const ToolPose a = leaning({0.1, 0.2, -5}, 0.3);
      carving.move(a, {a.tip_mm, turned(a.axis, {0.3, 1, 0.2}, turn)});
      carving.expect_within_tolerance(t.name + " turn " + std::to_string(turn));
    }
  }
}

TEST(Degenerate, TurnAboutTheBallCenterLeavesTheBallAtRest) {
  const Tool tool = *make_tool(BallShape{10, 12});
  const Vec3 center{0.1, -0.2, -2};
  for (const double turn : {1e-9, 0.02, 1.0, 2.9}) {
    Carving carving(small_block(), tool);
    const Vec3 u = kUp, w = turned(u, {1, 0.2, 0}, turn);
    carving.move({center - u * 5, u}, {center - w * 5, w});
    carving.expect_within_tolerance("turn " + std::to_string(turn));
  }
}

TEST(Degenerate, TurnAboutAPointOfTheShank) {
  for (const NamedTool& t : every_tool()) {
    for (const double pivot : {2.5, 5.0, 20.0, 49.999, 200.0, -30.0}) {
      Carving carving(small_block(), t.tool);
      const ToolPose a = leaning({0.1, 0.2, -5}, 0.25, 1);
      const Vec3 u = turned(a.axis, {0.3, 1, 0.2}, 0.3);
      carving.move(a, {a.tip_mm + (a.axis - u) * pivot, u});
      carving.expect_within_tolerance(t.name + " pivot " + std::to_string(pivot));
    }
  }
}

TEST(Degenerate, AxisParallelToMotion) {
  for (const NamedTool& t : every_tool()) {
    for (const double lean : {0.2, 0.9, 1.4, kPi / 2, 2.0}) {
      Carving carving(small_block(1e-5), t.tool);
      const ToolPose a = leaning({0.3, 0.1, -4}, lean, 0.4);
      carving.move(a, {a.tip_mm + a.axis * -6.0, a.axis});
      carving.expect_within_tolerance(t.name + " lean " + std::to_string(lean));
    }
  }
}

TEST(Degenerate, TranslationsAreExactForAnyTilt) {
  std::mt19937_64 random(8);
  const test::Uniform in(random);
  for (const NamedTool& t : every_tool()) {
    for (int k = 0; k < 8 * effort(); ++k) {
      SculptureSettings settings = small_block(1e-6);
      settings.rays = k % 2 == 0 ? Rays::kDexel : Rays::kTriDexel;
      Carving carving(settings, t.tool);
      const ToolPose a = leaning({in(-4, 4), in(-4, 4), in(-8, -2)}, in(0, 2), in(0, 6.2));
      const double reach = k % 4 == 3 ? 60 : 6;
      carving.move(a, {a.tip_mm + Vec3{in(-1, 1), in(-1, 1), in(-0.5, 0.5)} * reach, a.axis});
      carving.expect_within_tolerance(t.name + " " + std::to_string(k), 25);
    }
  }
}

TEST(Degenerate, DistantArcReachingARayMidMotionIsFound) {
  // At both ends of the motion the rays are far from the barrel's arc; in between they hit it.
  SculptureSettings settings = small_block(1e-6);
  settings.rays = Rays::kTriDexel;
  Carving carving(
      settings, make_tool(ProfileShape{{ProfilePoint{2.5, 0}, ProfileArc{{2.5, 24}, 30}}}).value());
  const Vec3 axis{0.034486342072559996, -0.50999753794098213, 0.85948426600176386};
  carving.move({{2.3776783179165113, -2.917867986770871, -7.6818323640088657}, axis},
               {{40.53763108526514, -7.521485259630051, 17.394813593814007}, axis});
  carving.expect_within_tolerance("barrel", 400);
}

TEST(Degenerate, ArcIsFoundByRaysInsideItsBoundingBall) {
  // At the start, rays hit the arc's bounding ball, but are closest to the arc outside that ball.
  SculptureSettings settings = small_block(1e-6);
  settings.rays = Rays::kTriDexel;
  Carving bull_nose(settings, make_tool(BullNoseShape{10, 2, 50}).value());
  const Vec3 axis{0.68401015769438511, -0.49843577391730659, 0.53262734012661983};
  bull_nose.move({{0.52567567349211863, 2.8775911321724212, -2.2652246427579339}, axis},
                 {{-3.444566107618904, -2.5748682404586134, -1.5744821836938114}, axis});
  bull_nose.expect_within_tolerance("bull_nose", 25);

  Carving apt(
      settings,
      make_tool(AptShape{10, 1.5, 3.630717035815369, 2.0250053615596113, 8, 6, 40}).value());
  const Vec3 leaning_axis{-0.40082607110029878, 0.092256161467074868, 0.9114972635162758};
  apt.move({{2.6814109717217516, 3.1459825179412713, -4.7458975776981918}, leaning_axis},
           {{-42.756855175410863, -17.094742603594515, -16.381372912808828}, leaning_axis});
  apt.expect_within_tolerance("apt", 25);
}

/// A ramp whose slope is exactly a cone's angle, one double to either side, and slightly farther:
/// the leading coefficient of the cone's equation is 0, or rounds to 0.
TEST(Degenerate, RampAtTheConeAngle) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double half_angle : {45.0, 30.0, 12.0, 80.0}) {
    const Tool tools[] = {*make_tool(ConeEndShape{8, 2 * half_angle, 50}),
                          *make_tool(TaperShape{1, half_angle, 10})};
    for (const Tool& tool : tools) {
      const double slope = 1 / std::tan(half_angle * kPi / 180);
      for (const double s : {slope, std::nextafter(slope, inf), std::nextafter(slope, 0.0),
                             slope * (1 + 1e-12), slope * (1 - 1e-9), -slope}) {
        const double run = 3 / std::max(1.0, slope);
        Carving carving(small_block(1e-5), tool);
        const auto taken =
            carving.move({{-1, 0.1, -3}, kUp}, {{-1 + run, 0.1, -3 - run * s}, kUp}).removed_mm3;
        EXPECT_GT(taken, 1);
        carving.expect_within_tolerance("half angle " + std::to_string(half_angle) + " slope " +
                                        std::to_string(s));
      }
    }
  }
}

TEST(Degenerate, HalfTurnIsRejectedAndSlightlyLessIsAccepted) {
  Carving carving(small_block(0.05), *make_tool(BallShape{6, 20}));
  Sculpture& s = carving.sculpture();
  const std::uint64_t before = s.state_hash();
  const Vec3 tip{0, 0, -2};
  for (const double degrees : {180.0, 179.999, 171.0, 170.001}) {
    const Vec3 u = turned(kUp, {0, 1, 0}, degrees * kPi / 180);
    const auto moved = s.apply(MoveTool{1, {tip, kUp}, {tip, u}, 0.01});
    ASSERT_FALSE(moved) << degrees;
    EXPECT_EQ(moved.error().code, SculptureErrorCode::kTurnTooLarge);
    EXPECT_EQ(s.state_hash(), before);
  }
  const auto flipped = s.apply(MoveTool{1, {tip, kUp}, {tip, {0, 0, -1}}, 0.01});
  ASSERT_FALSE(flipped);
  EXPECT_EQ(flipped.error().code, SculptureErrorCode::kTurnTooLarge);
  carving.move({tip, kUp}, {tip, turned(kUp, {0.2, 1, 0}, 169.999 * kPi / 180)});
  carving.expect_within_tolerance("169.999 degrees");
}

TEST(Degenerate, ToolLyingAlongARowOrAColumn) {
  for (const NamedTool& t : every_tool()) {
    for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, -1, 0}}) {
      for (const Vec3 travel :
           {Vec3{2, 0, 0}, Vec3{0, 2, 0}, Vec3{0, 0, -2}, Vec3{1, 1, -1}, Vec3{}}) {
        Carving carving(small_block(1e-5), t.tool);
        const Vec3 tip = Vec3{0.1, 0.2, -6} - axis * 8.0;
        carving.move({tip, axis}, {tip + travel, axis});
        carving.expect_within_tolerance(t.name, 20);
      }
    }
  }
}

TEST(Degenerate, LyingCylinderRemovesItsChords) {
  // Radius 3 along +X, sunk to its axis: it removes half a cylinder.
  SculptureSettings fine = block(20, 8, 0.02, 1e-3);
  const ToolPose pose{{-6, 0, 0}, {1, 0, 0}};
  const double taken = volume_taken(fine, *make_tool(FlatShape{6, 12}), pose, pose);
  EXPECT_NEAR(taken / (kPi * 9 / 2 * 12), 1, 1e-3);
}

TEST(Degenerate, TurnIntoTheHorizontalAndUpsideDown) {
  for (const NamedTool& t : every_tool()) {
    Carving level(small_block(), t.tool);
    level.move({{-5, 0.2, -3}, kUp}, {{-4, 0.2, -3}, {1, 0, 0}});
    level.expect_within_tolerance(t.name + " to the horizontal");
    Carving below(small_block(), t.tool);
    below.move({{0.1, 0.2, -9}, {0, 0, -1}}, {{1.1, 0.2, -8}, {0, 0, -1}});
    below.expect_within_tolerance(t.name + " from below");
    Carving past(small_block(), t.tool);
    past.move({{-3, 0.2, -9}, {0.6, 0, 0.8}}, {{-3, 1, -9}, {0.6, 0, -0.8}});
    past.expect_within_tolerance(t.name + " past the horizontal");
  }
}

TEST(Degenerate, TangentRayRemovesNothingMeasurable) {
  // Columns are at whole millimeters; the tool's side touches those at distance 4 exactly.
  SculptureSettings s = block(21, 12, 1, 1e-6);
  const Vec3 across{0, 3, 0};
  for (const ToolShape& shape : {ToolShape{BallShape{8, 50}}, ToolShape{FlatShape{8, 50}}}) {
    for (const Vec3 travel : {Vec3{}, across, Vec3{0, 0, -2}, Vec3{0, 1, -1}}) {
      Carving carving(s, *make_tool(shape));
      carving.move({{0, 0, -5}, kUp}, {Vec3{0, 0, -5} + travel, kUp});
      carving.expect_within_tolerance("upright", 60);
      const DexelSnapshot snapshot = carving.sculpture().snapshot();
      for (const int i : {5, 15}) {  // x = -5, 5: clear of the tool.
        EXPECT_EQ(column_of(snapshot, i, 10).size(), 1u);
      }
    }
    Carving lying(s, *make_tool(shape));
    lying.move({{-9, 0, -6}, {1, 0, 0}}, {{-6, 0, -6}, {1, 0, 0}});
    lying.expect_within_tolerance("lying", 60);
  }
}

TEST(Degenerate, ToolFlushWithTheStockRemovesNothing) {
  for (const NamedTool& t : every_tool()) {
    Carving carving(small_block(1e-5), t.tool);
    const auto expect_nothing = [&](const ToolPose& a, const ToolPose& b, const char* what) {
      const MotionResult r = carving.move(a, b);
      EXPECT_EQ(r.removed_mm3, 0) << t.name << ' ' << what;
      EXPECT_TRUE(r.changed_tiles.empty()) << t.name << ' ' << what;
    };
    expect_nothing({{-10, 0.3, 0}, kUp}, {{10, 0.3, 0}, kUp}, "over the top");
    expect_nothing({{-10, 0.3, 5}, kUp}, {{-10, 0.3, 0}, kUp}, "down to the top");
    expect_nothing({{-10, 0.3, 0}, kUp}, {{-10, 0.3, 0}, kUp}, "standing on the top");
    expect_nothing({{-10, 0.3, -16}, {0, 0, -1}}, {{10, 0.3, -16}, {0, 0, -1}}, "under the bottom");
    const double r = t.tool.radius_mm;
    expect_nothing({{-15 - r, -9, -8}, kUp}, {{-15 - r, 9, -8}, kUp}, "along the side");
    expect_nothing({{-9, 15 + r, -8}, kUp}, {{9, 15 + r, -8}, kUp}, "along the back");
  }
}

TEST(Degenerate, FlushFloorsMeetWithoutASliver) {
  // Two adjacent passes at one height, and one lower by less than a quantum.
  Carving carving(small_block(1e-6), *make_tool(FlatShape{6, 30}));
  carving.move({{-9, -2, -4}, kUp}, {{9, -2, -4}, kUp});
  carving.move({{-9, 2, -4}, kUp}, {{9, 2, -4}, kUp});
  const MotionResult again = carving.move({{-8, 0, -4}, kUp}, {{8, 0, -4}, kUp});
  EXPECT_EQ(again.removed_mm3, 0);
  const DexelSnapshot s = carving.sculpture().snapshot();
  const DexelGrid& g = s.grid();
  for (std::int32_t j = 0; j < g.columns_y; ++j) {
    if (std::abs(g.y_mm(j)) > 4.9) continue;
    for (std::int32_t i = 0; i < g.columns_x; ++i) {
      if (std::abs(g.x_mm(i)) > 9) continue;
      const auto column = column_of(s, i, j);
      ASSERT_EQ(column.size(), 1u);
      EXPECT_NEAR(g.z_mm(column[0].top), -4, g.z_quantum_mm);
    }
  }
}

TEST(Degenerate, CuttingTheSamePathAgainChangesNothing) {
  for (const NamedTool& t : every_tool()) {
    Carving carving(small_block(0.01), t.tool);
    const ToolPose a = leaning({-4, 0.3, -3}, 0.2);
    const ToolPose path[] = {
        a, {{2, 1, -4}, a.axis}, leaning({3, 2, -4}, 0.5, 1), leaning({3, 2, -6}, 1.2, 2)};
    for (int k = 1; k < 4; ++k) carving.move(path[k - 1], path[k]);
    const std::uint64_t state = carving.sculpture().state_hash();
    for (int k = 1; k < 4; ++k) {
      const MotionResult r = carving.move(path[k - 1], path[k]);
      EXPECT_EQ(r.removed_mm3, 0) << t.name;
      EXPECT_TRUE(r.changed_tiles.empty()) << t.name;
      EXPECT_EQ(r.wrench.force_n, Vec3{}) << t.name;
    }
    EXPECT_EQ(carving.sculpture().state_hash(), state) << t.name;
  }
}

TEST(Degenerate, ToolOutsideTheBlockRemovesNothing) {
  for (const NamedTool& t : every_tool()) {
    Carving carving(small_block(0.01), t.tool);
    const std::uint64_t state = carving.sculpture().state_hash();
    const auto pass = [&](Vec3 a, Vec3 b, Vec3 u, Vec3 v) {
      const MotionResult r = carving.move({a, u}, {b, v});
      EXPECT_EQ(r.removed_mm3, 0) << t.name;
      EXPECT_TRUE(r.changed_tiles.empty()) << t.name;
    };
    pass({-20, 0, 1}, {20, 0, 1}, kUp, kUp);
    pass({-90, -90, -5}, {-90, 90, -5}, kUp, kUp);
    pass({0, 0, -300}, {5, 5, -300}, kUp, normalized({0.1, 0, 1}));
    pass({1e6, 1e6, 1e6}, {-1e6, 1e6, 1e6}, kUp, kUp);
    pass({40, 0, 5}, {40, 0, 5}, kUp, normalized({0.7, 0.1, 0.7}));
    EXPECT_EQ(carving.sculpture().state_hash(), state) << t.name;
  }
}

TEST(Degenerate, ConeAnglesNearZeroAndNear90Degrees) {
  const Tool tools[] = {*make_tool(TaperShape{4, 0.01, 40}),
                        *make_tool(TaperShape{0.4, 89.99, 0.05}),
                        *make_tool(TaperShape{4, 0.01, 40, TaperTip::kBall}),
                        *make_tool(TaperShape{4, 89, 2.5, TaperTip::kBall}),
                        *make_tool(ConeEndShape{0.01, 0.02, 50}),
                        *make_tool(ConeEndShape{10, 179.98, 50})};
  for (std::size_t k = 0; k < std::size(tools); ++k) {
    SculptureSettings s = block(30, 16, k == 4 ? 0.001 : 0.37, 1e-4);
    if (k == 4) s.stock = BoxStock{{-0.02, -0.02, -16}, {0.02, 0.02, 0}};
    const double reach = k == 4 ? 0.003 : 2;
    const ToolPose a{{-reach, 0.0003, -4}, kUp};
    Carving level(s, tools[k]);
    level.move(a, {{reach, 0.0003, -4}, kUp});
    level.expect_within_tolerance("level, tool " + std::to_string(k));
    Carving ramp(s, tools[k]);
    ramp.move(a, {{reach, 0.0005, -5}, kUp});
    ramp.expect_within_tolerance("ramp, tool " + std::to_string(k));
    Carving swing(s, tools[k]);
    swing.move(a, leaning({reach, 0, -4.2}, k == 4 ? 0.0004 : 0.3, 0.5));
    swing.expect_within_tolerance("swing, tool " + std::to_string(k));
  }
}

}  // namespace
}  // namespace kerf::test::degenerate_test
