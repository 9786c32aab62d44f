// SPDX-License-Identifier: Apache-2.0
// Forces compared with values derived by hand.

#include "kernel/force/cutting_force.h"

#include "kernel/sculpture.h"
#include "tests/support/swivel.h"
#include "tests/support/test.h"

namespace kerf::cutting_force_test {
namespace {

const Vec3 kUp{0, 0, 1};
constexpr double kSpecific = 0.5;
constexpr double kDrr = 0.01;
constexpr double kPivot = 60;

Sculpture block(ForceLaw law, const ToolShape& shape, double pitch_mm = 0.1) {
  auto s = *Sculpture::create({.stock = BoxStock{{-20, -20, -20}, {20, 20, 0}},
                               .pitch_mm = pitch_mm,
                               .tolerance_mm = 0.001,
                               .force = {law, kSpecific, kDrr, kPivot}});
  s.apply(DefineTool{1, *make_tool(shape)}).value();
  return s;
}

/// Follows a straight path in ticks; returns the mean force and the removed volume.
struct Path {
  Vec3 force;
  double removed_mm3 = 0;
};

Path follow(Sculpture& s, Vec3 from, Vec3 to, int ticks, double tick_s) {
  Path r;
  for (int i = 0; i < ticks; ++i) {
    const Vec3 a = from + (to - from) * (double(i) / ticks);
    const Vec3 b = from + (to - from) * (double(i + 1) / ticks);
    const MotionResult m = s.apply(MoveTool{1, {a, kUp}, {b, kUp}, tick_s}).value();
    r.force = r.force + m.wrench.force_n * (1.0 / ticks);
    r.removed_mm3 += m.removed_mm3;
  }
  return r;
}

TEST(Force, OneDexelPushesAgainstTheMotionAndTurnsAboutThePivot) {
  // A single removed segment at a known position: dV = 0.5 mm x (0.5 mm)^2 around (1, 2, -0.25),
  // moving along +X with the tip at (0.25, 2, -0.5), the pivot 10 mm above it.
  const DexelGrid grid{{0.75, 1.75, -1}, 0.5, 0.25, 1, 1, 4};
  const std::vector<RemovedGroup> removed{{0, 0, {2}, {4}}};
  const Twist along_x{{0.5, 0, 0}, {}};
  const CutSummer summer(grid, along_x, {{0.25, 2, -0.5}, kUp, 10, 50, 5}, nullptr);
  const auto [sum, across_mm, along_mm] = summer.total(summer.sum(removed));
  EXPECT_DOUBLE_EQ(across_mm, 0.5);
  EXPECT_EQ(along_mm, 0);
  const double volume = 0.5 * 0.25;
  EXPECT_NEAR(sum.volume_mm3, volume, 1e-15);
  EXPECT_NEAR(sum.push_mm3.x, -volume, 1e-15);
  EXPECT_EQ(sum.push_mm3.y, 0);
  EXPECT_EQ(sum.push_mm3.z, 0);
  // Pivot at (0.25, 2, 9.5); arm = (1, 2, -0.25) − pivot = (0.75, 0, −9.75); torque = arm × f =
  // (0, 9.75 f, 0).
  EXPECT_NEAR(sum.turn_mm4.y, 9.75 * volume, 1e-12);
  EXPECT_EQ(sum.turn_mm4.x, 0);
  EXPECT_EQ(sum.turn_mm4.z, 0);
  EXPECT_NEAR(sum.center_mm().x, 0.75, 1e-12);
  EXPECT_NEAR(sum.center_mm().z, 0.25, 1e-12);
}

TEST(Force, PlungePushesUpWithTheExactRemovalRate) {
  // Flat: area π r². Ball of radius 5 between depths 2 and 3: mean area of the cap's circles, π (2
  // r h − h²) averaged.
  const double flat_area = M_PI * 25;
  const double ball_area = M_PI * (5 * (9 - 4) - (27 - 8) / 3.0);
  for (const auto& [shape, area] : {std::pair<ToolShape, double>{FlatShape{10, 50}, flat_area},
                                    {BallShape{10, 50}, ball_area}}) {
    auto s = block(ForceLaw::kSpecificEnergy, shape);
    follow(s, {0, 0, 1}, {0, 0, -2}, 30, 0.001);
    const Path r = follow(s, {0, 0, -2}, {0, 0, -3}, 40, 0.001);
    EXPECT_NEAR(r.force.z / (kSpecific * area), 1, 0.01);
    EXPECT_NEAR(r.force.x, 0, 1e-9);
    EXPECT_NEAR(r.removed_mm3 / area, 1, 0.01);
  }
}

TEST(Force, SlotPushesBackWithTheExactRemovalRate) {
  // Slot 2 mm deep. Flat: width 10 x 2. Ball: circular segment of height 2 in a circle of radius 5.
  const double segment = 25 * std::acos(3.0 / 5) - 3 * std::sqrt(25 - 9.0);
  for (const auto& [shape, area] :
       {std::pair<ToolShape, double>{FlatShape{10, 50}, 20}, {BallShape{10, 50}, segment}}) {
    auto s = block(ForceLaw::kSpecificEnergy, shape);
    follow(s, {-12, 0.033, -2}, {0, 0.033, -2}, 120, 0.001);
    const Path r = follow(s, {0, 0.033, -2}, {1, 0.033, -2}, 33, 0.001);
    EXPECT_NEAR(r.force.x / (-kSpecific * area), 1, 0.01);
    EXPECT_NEAR(r.force.z, 0, 1e-9);
    EXPECT_NEAR(r.removed_mm3 / area, 1, 0.01);
  }
}

TEST(Force, SideCutPushesBackWithTheExactRemovalRate) {
  // Flat: the flank removes a strip 2 mm wide and 3 mm deep along the block's side.
  auto s = block(ForceLaw::kSpecificEnergy, FlatShape{10, 50});
  follow(s, {-15, 23.0, -3}, {0, 23.0, -3}, 150, 0.001);
  const Path r = follow(s, {0, 23.0, -3}, {1, 23.0, -3}, 30, 0.001);
  EXPECT_NEAR(r.force.x / (-kSpecific * 2 * 3), 1, 0.01);

  // Ball, its center on the face: the quarter of its section that is below the surface and inside.
  auto b = block(ForceLaw::kSpecificEnergy, BallShape{10, 50});
  follow(b, {-15, 20.0, -5}, {0, 20.0, -5}, 150, 0.001);
  const Path q = follow(b, {0, 20.0, -5}, {1, 20.0, -5}, 30, 0.001);
  EXPECT_NEAR(q.force.x / (-kSpecific * M_PI * 25 / 4), 1, 0.01);
}

TEST(Force, RemovalRateLawGrowsWithSpeed) {
  for (const double tick_s : {0.001, 0.004}) {
    auto s = block(ForceLaw::kDexelRemovalRate, FlatShape{10, 50});
    follow(s, {-12, 0, -2}, {0, 0, -2}, 120, tick_s);
    const Path r = follow(s, {0, 0, -2}, {2, 0, -2}, 20, tick_s);  // 0.1 mm per tick
    const double rate = 20 * 0.1 / tick_s;
    EXPECT_NEAR(r.force.x / (-kDrr * rate), 1, 0.01);
  }
}

TEST(Force, DoesNotDependOnTheTickRate) {
  Vec3 reference;
  for (const int ticks : {10, 40, 160}) {
    auto s = block(ForceLaw::kSpecificEnergy, BallShape{10, 50});
    follow(s, {-12, 0, -2}, {0, 0, -2}, 60, 0.001);
    const Path r = follow(s, {0, 0, -2}, {4, 0, -2}, ticks, 0.16 / ticks);
    if (ticks == 10) {
      reference = r.force;
    } else {
      EXPECT_NEAR(r.force.x / reference.x, 1, 0.02) << ticks;
    }
  }
}

TEST(ForceDirection, AxialCutPushesAlongTheAxis) {
  auto s = block(ForceLaw::kSpecificEnergy, BallShape{10, 50});
  const Vec3 axis = normalized({0.3, 0.2, 1});
  const auto down = s.apply(MoveTool{1, {axis * 2, axis}, {axis * -4, axis}, 0.1}).value();
  EXPECT_EQ(down.kind, MotionKind::kAxial);
  EXPECT_NEAR(dot(normalized(down.wrench.force_n), axis), 1, 1e-9);

  auto from_below = block(ForceLaw::kSpecificEnergy, FlatShape{10, 5});
  const auto up =
      from_below.apply(MoveTool{1, {{0, 0, -26}, kUp}, {{0, 0, -22}, kUp}, 0.1}).value();
  EXPECT_GT(up.removed_mm3, 0);
  EXPECT_LT(up.wrench.force_n.z, 0);
}

TEST(ForceDirection, RotationIsOpposedAroundTheTip) {
  auto s = block(ForceLaw::kSpecificEnergy, FlatShape{10, 15});
  const auto r =
      s.apply(MoveTool{1, {{0, 0, -10}, kUp}, {{0, 0, -10}, normalized({0.3, 0, 1})}, 0.1}).value();
  EXPECT_EQ(r.kind, MotionKind::kRotation);
  EXPECT_GT(r.removed_mm3, 0);
  EXPECT_LT(r.wrench.force_n.x, 0);  // The shaft moves to +X.
  EXPECT_GT(r.wrench.torque_nmm.y,
            0);  // The push below the pivot increases the turn.
}

TEST(ForceDirection, GeneralMotionIsOpposedAlongTheTipsPath) {
  auto s = block(ForceLaw::kSpecificEnergy, BallShape{10, 50});
  const auto r =
      s.apply(MoveTool{1, {{-5, 0, -3}, kUp}, {{5, 0, -3}, normalized({0, 0.1, 1})}, 0.1}).value();
  EXPECT_EQ(r.kind, MotionKind::kGeneral);
  // Elements push against their own displacements, which a small turn makes differ.
  EXPECT_NEAR(normalized(r.wrench.force_n).x, -1, 1e-3);
}

TEST(Force, HasNoTorqueAboutTheToolsAxis) {
  auto s = block(ForceLaw::kSpecificEnergy, BallShape{10, 50});
  const Vec3 axis = normalized({0.4, -0.3, 1});
  s.apply(MoveTool{1, {{-9, 2, -4}, axis}, {{0, 2, -4}, axis}, 0.1}).value();
  const auto r = s.apply(MoveTool{1, {{0, 2, -4}, axis}, {{0, 6, -4}, axis}, 0.1}).value();
  EXPECT_GT(length(r.wrench.torque_nmm), 1);
  EXPECT_NEAR(dot(r.wrench.torque_nmm, axis), 0, 1e-9 * length(r.wrench.torque_nmm));
}

TEST(Force, IsNotComputedWithoutFeel) {
  auto s = block(ForceLaw::kSpecificEnergy, BallShape{10, 50});
  const auto r = s.apply(MoveTool{1, {{-9, 2, -4}, kUp}, {{0, 2, -4}, kUp}, 0.1, false}).value();
  EXPECT_GT(r.removed_mm3, 0);
  EXPECT_EQ(r.wrench, Wrench{});
}

TEST(Force, IsZeroInAir) {
  auto s = block(ForceLaw::kSpecificEnergy, BallShape{10, 50});
  EXPECT_EQ(s.apply(MoveTool{1, {{-9, 2, 4}, kUp}, {{0, 2, 4}, kUp}, 0.1}).value().wrench,
            Wrench{});
}

TEST(Force, SwivelDoesTheWorkOfTheRemovedVolume) {
  const Tool flat = *make_tool(FlatShape{6, 40}), ball = *make_tool(BallShape{6, 40}),
             bull_nose = *make_tool(BullNoseShape{8, 1.5, 40});
  for (const double above_tip_mm : {-5.0, 2.0, 5.0, 9.0, 30.0}) {
    for (const Tool& tool : {flat, ball, bull_nose}) {
      for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
        const double share = test::work_over_energy(
            {.tool = tool, .rays = rays, .pitch_mm = 0.15, .above_tip_mm = above_tip_mm});
        EXPECT_NEAR(share, 1, 0.01) << above_tip_mm << " mm, " << to_string(rays);
      }
    }
  }
}

/// Cuts a slot along +X, then swivels in it about Y, about the point `about` from the tip. Returns
/// the greatest force of the swivel over that of the slot.
double swivel_over_slot(const ToolShape& shape, Rays rays, Vec3 about) {
  constexpr double kTickRad = 0.01;
  Sculpture b = *Sculpture::create({.stock = BoxStock{{-15, -15, -10}, {15, 15, 0}},
                                    .rays = rays,
                                    .pitch_mm = 0.2,
                                    .tolerance_mm = 0.002,
                                    .force = {ForceLaw::kSpecificEnergy, kSpecific, kDrr, kPivot}});
  b.apply(DefineTool{1, *make_tool(shape)}).value();
  Vec3 tip{-8, 0.02, -3};
  b.apply(MoveTool{1, {{-25, 0.02, -3}, kUp}, {tip, kUp}, 1, false}).value();
  double slot = 0;
  for (int i = 0; i < 100; ++i) {
    const Vec3 to = tip + Vec3{0.03, 0, 0};
    slot = length(b.apply(MoveTool{1, {tip, kUp}, {to, kUp}, 0.001})->wrench.force_n);
    tip = to;
  }
  const auto pose = [&](int tick) {
    const double s = std::sin(tick * kTickRad), c = std::cos(tick * kTickRad);
    const Vec3 turned{about.x * c + about.z * s, 0, about.z * c - about.x * s};
    return ToolPose{tip + about - turned, {s, 0, c}};
  };
  double most = 0;
  for (int i = 0; i < 60; ++i) {
    const auto r = b.apply(MoveTool{1, pose(i), pose(i + 1), 0.001});
    most = std::max(most, length(r->wrench.force_n));
  }
  return most / slot;
}

TEST(Force, SwivelAboutPendingCutDoesNotDeliverItAtOnce) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    for (const Vec3 about : {Vec3{2, 0, 1.5}, Vec3{2.5, 0, 1}, Vec3{1, 0, 2}}) {
      EXPECT_LT(swivel_over_slot(BallShape{6, 30}, rays, about), 1.3)
          << "ball, " << to_string(rays) << ", " << about.x;
      EXPECT_LT(swivel_over_slot(FlatShape{6, 30}, rays, about), 1.3)
          << "flat, " << to_string(rays) << ", " << about.x;
    }
  }
}

TEST(Force, StoppingKeepsTheForceOfACutAlongAndAcrossTheRays) {
  Sculpture b = block(ForceLaw::kSpecificEnergy, BallShape{6, 40});
  const auto at = [](int i) { return ToolPose{{-10 + i * 0.03, 0.02, -2 - i * 0.03}, kUp}; };
  b.apply(MoveTool{1, {{-30, 0.02, -2}, kUp}, at(0), 1, false}).value();
  double moving = 0;
  for (int i = 0; i < 60; ++i)
    moving = length(b.apply(MoveTool{1, at(i), at(i + 1), 0.001})->wrench.force_n);
  const double resting = length(b.apply(MoveTool{1, at(60), at(60), 0.001})->wrench.force_n);
  EXPECT_NEAR(resting / moving, 1, 0.1);
}

}  // namespace
}  // namespace kerf::cutting_force_test
