// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/guides/guide_model.h"

#include "haptic_agent/guides/surface_distance.h"
#include "haptic_agent/servo/mapping/block_settings.h"
#include "tests/agent/servo/late_spring.h"
#include "tests/support/test.h"

namespace kerf::agent::guide_model_test {
namespace {

constexpr double kPivotMm = 50;

/// A grip whose tip is at `tip_mm`, at rest unless stated.
PastGrip at(Vec3 tip_mm, Vec3 axis = {0, 0, 1}, Twist velocity = {}) {
  return {.grip = {tip_mm + axis * kPivotMm, axis}, .velocity = velocity};
}

ServoSettings settings() { return {.pivot_mm = kPivotMm}; }

GuideModel model(const Guide& guide, double strength = 1) {
  return {{guide}, settings(), strength};
}

void expect_force(const Wrench& wrench, Vec3 force_n, Vec3 torque_nmm = {}) {
  EXPECT_LT(length(wrench.force_n - force_n), 1e-9)
      << wrench.force_n.x << ' ' << wrench.force_n.y << ' ' << wrench.force_n.z;
  EXPECT_LT(length(wrench.torque_nmm - torque_nmm), 1e-7)
      << wrench.torque_nmm.x << ' ' << wrench.torque_nmm.y << ' ' << wrench.torque_nmm.z;
}

GuidePath line(Vec3 from, Vec3 to, Vec3 axis = {0, 0, 1}, Wrench felt = {}) {
  return {{.tip_mm = from, .axis = axis, .felt = felt}, {.tip_mm = to, .axis = axis, .felt = felt}};
}

TEST(GuideModel, PathPullsTheTipBackToItsDistanceOnly) {
  GuideModel guides = model(
      {.shape = PathGuide{.within_mm = 3, .file = {}, .paths = {line({0, 0, 0}, {20, 0, 0})}}});
  expect_force(guides.at(at({10, 2.9, 0})), {});
  // 1.5 N toward the path; about the pivot, 50 mm above the tip: (0, 0, -50) x (0, -1.5, 0).
  expect_force(guides.at(at({10, 4.5, 0})), {0, -1.5, 0}, {-75, 0, 0});
  expect_force(guides.at(at({25, 0, 0})), {-2, 0, 0}, {0, 100, 0});
  expect_force(guides.at(at({10, 40, 0})), {0, -3, 0}, {-150, 0, 0});  // the guide's greatest force
  EXPECT_EQ(guides.uses().front().ticks, 3U);
  EXPECT_DOUBLE_EQ(guides.uses().front().max_force_n, 3);
}

TEST(GuideModel, PathTurnsTheAxisBackToItsAngleOnly) {
  GuideModel guides = model({.shape = PathGuide{.axis_within_deg = 10,
                                                .turn_stiffness_nmm_per_rad = 100,
                                                .file = {},
                                                .paths = {line({0, 0, 0}, {20, 0, 0})}}});
  const auto tilted = [](double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    return Vec3{std::sin(angle), 0, std::cos(angle)};
  };
  expect_force(guides.at(at({10, 0, 0}, tilted(9.9))), {});
  // From +x back to +z the axis turns about -y.
  expect_force(guides.at(at({10, 0, 0}, tilted(20))), {},
               {0, -100 * 10 * std::numbers::pi / 180, 0});
  expect_force(guides.at(at({10, 0, 0}, tilted(80))), {}, {0, -60, 0});
}

TEST(GuideModel, PlaneDepthAndRegionAreWalls) {
  GuideModel plane = model({.shape = PlaneGuide{{0, 0, 5}, {0.6, 0, 0.8}}});
  expect_force(plane.at(at({0, 0, 5.1})), {});
  expect_force(plane.at(at({-1, 0, 4.25})), {0.72, 0, 0.96}, {0, -36, 0});
  GuideModel depth = model({.shape = DepthGuide{-4}, .stiffness_n_per_mm = 0.5});
  expect_force(depth.at(at({0, 0, -4})), {});
  expect_force(depth.at(at({0, 0, -6})), {0, 0, 1});
  GuideModel region = model({.shape = RegionGuide{{0, 0, 0}, {20, 10, 10}}});
  expect_force(region.at(at({10, -0.1, 5})), {});
  expect_force(region.at(at({10, 2, 5})), {0, -2, 0}, {-100, 0, 0});
  expect_force(region.at(at({19, 5, 5})), {1, 0, 0}, {0, -50, 0});
}

TEST(GuideModel, SnapAttractsWithinItsRange) {
  const SnapSurface box{false, {-20, -20, -20}, {20, 20, 0}};
  GuideModel snap = model({.shape = SnapGuide{.range_mm = 4, .surface = box}});
  expect_force(snap.at(at({0, 0, 0})), {});
  expect_force(snap.at(at({0, 0, 1})), {0, 0, -1});
  expect_force(snap.at(at({0, 0, -1})), {0, 0, 1});
  expect_force(snap.at(at({0, 0, 2})), {0, 0, -1.5 * 4 / 3});
  expect_force(snap.at(at({0, 0, 3.5})), {0, 0, -0.5});
  expect_force(snap.at(at({0, 0, 4.1})), {});
  const SnapSurface rod{true, {-10, -10, -20}, {10, 10, 0}};
  GuideModel round = model({.shape = SnapGuide{.range_mm = 4, .surface = rod}});
  expect_force(round.at(at({6.6, 8.8, -10})), {-0.6, -0.8, 0}, {-40, 30, 0});
}

TEST(GuideModel, StrokeIsFeltForwardAndNearOnly) {
  const Wrench taught{{-1, 0, 0.5}, {0, 50, 0}};
  GuideModel guides =
      model({.shape = PathGuide{.within_mm = 2,
                                .stroke = true,
                                .felt_share = 0.5,
                                .file = {},
                                .paths = {line({0, 0, 0}, {20, 0, 0}, {0, 0, 1}, taught)}}});
  // Steps of 0.1 mm over much more than the 3 mm that determine the direction of travel.
  const auto move = [&](double from_mm, double to_mm, double beside_mm) {
    Wrench last;
    const double step = from_mm < to_mm ? 0.1 : -0.1;
    for (double x = from_mm; (to_mm - x) * step > 0; x += step)
      last = guides.at(at({x, beside_mm, 0}));
    return last;
  };
  Wrench forward = move(0, 19, 0);
  EXPECT_NEAR(forward.force_n.x, -0.5, 0.01);
  EXPECT_NEAR(forward.force_n.z, 0.25, 0.005);
  EXPECT_NEAR(forward.torque_nmm.y, 25, 0.5);
  expect_force(move(19, 5, 0), {});
  forward = move(5, 19, 3);  // beyond 2 mm the guide pulls back with 1 N, and half is felt
  EXPECT_NEAR(forward.force_n.x, -0.25, 0.01);
  EXPECT_NEAR(forward.force_n.y, -1, 1e-9);
}

/// Returns the wrench at the hand for a tip in device space, behind a mapping.
Wrench felt(GuideModel& guides, const SpaceMap& map, Vec3 tip_mm) {
  return map.to_device(guides.at(map.to_block(at(tip_mm))));
}

TEST(GuideModel, MappedForceHasTheGainAndTheHandsLever) {
  const SpaceMap map({.scale = 0.1, .gain = 2, .turn_rad = {0, 0, std::numbers::pi / 2}});
  GuideModel wall = model({.shape = PlaneGuide{{0, 0, 0}, {1, 0, 0}}});
  wall.adapt(block_settings(settings(), map.mapping()));
  // Device +y is the block's -x: 10 mm of the hand are 1 mm in the wall, which pushes with 1 N.
  expect_force(felt(wall, map, {0, 10, 0}), {0, -2, 0}, {-100, 0, 0});

  const SpaceMap half({.scale = 0.5, .gain = 2});
  GuideModel stroke =
      model({.shape = PathGuide{
                 .within_mm = 2,
                 .stroke = true,
                 .felt_share = 0.5,
                 .file = {},
                 .paths = {line({0, 0, 0}, {20, 0, 0}, {0, 0, 1}, {{-1, 0, 0}, {0, 50, 0}})}}});
  stroke.adapt(block_settings(settings(), half.mapping()));
  Wrench last;
  for (double x = 0; x < 38; x += 0.2) last = felt(stroke, half, {x, 0, 0});
  EXPECT_NEAR(last.force_n.x, -1, 0.02);
  EXPECT_NEAR(last.torque_nmm.y, 50, 1) << "the teacher's force is at the tip";
}

TEST(GuideModel, StrengthScalesAllGuidesAndZeroDisablesThem) {
  const Guide guide{.shape = DepthGuide{0}};
  GuideModel half = model(guide, 0.5);
  expect_force(half.at(at({0, 0, -2})), {0, 0, 1});
  expect_force(half.at(at({0, 0, -20})), {0, 0, 1.5});
  GuideModel none = model(guide, 0);
  EXPECT_EQ(none.at(at({0, 0, -2})), Wrench{});
  EXPECT_EQ(none.uses().front().ticks, 0U);
  EXPECT_THAT(guide_notice({guide}, 0), testing::HasSubstr("switched off"));
}

TEST(GuideModel, SpringsAreDampedAndNoStifferThanTheDevice) {
  ServoSettings soft = settings();
  soft.model.contact.max_stiffness = 0.25;
  GuideModel guides({{.shape = DepthGuide{0}, .stiffness_n_per_mm = 50}}, soft, 1);
  expect_force(guides.at(at({0, 0, -2})), {0, 0, 0.5});
  const double damping = soft.model.contact.max_damping;
  const Twist down{{0, 0, -100}, {}};
  expect_force(guides.at(at({0, 0, -2}, {0, 0, 1}, down)), {0, 0, 0.5 + damping * 100});
  EXPECT_EQ(guides.at(at({0, 0, -2}, {0, 0, 1}, down * -10)).force_n.z, 0) << "a wall never pulls";
}

TEST(GuideModel, ForceIsTheGradientOfAPotential) {
  // A guide returns no more energy than was put into it: the work around closed loops is zero.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> spread(-6, 6);
  const SnapSurface box{false, {-5, -5, -5}, {5, 5, 5}};
  for (const Guide& guide :
       {Guide{.shape =
                  PathGuide{.within_mm = 1, .file = {}, .paths = {line({-5, 0, 0}, {5, 1, 0})}}},
        Guide{.shape = RegionGuide{{-5, -5, -5}, {5, 5, 5}}},
        Guide{.shape = SnapGuide{.range_mm = 3, .surface = box}},
        Guide{.shape = PlaneGuide{{0, 0, 0}, {0.6, 0.8, 0}}}}) {
    GuideModel guides = model(guide);
    for (int loop = 0; loop < 20; ++loop) {
      const Vec3 corner[3] = {{spread(random), spread(random), spread(random)},
                              {spread(random), spread(random), spread(random)},
                              {spread(random), spread(random), spread(random)}};
      double work_mj = 0;
      constexpr int kSteps = 4000;
      for (int side = 0; side < 3; ++side) {
        const Vec3 step = (corner[(side + 1) % 3] - corner[side]) * (1.0 / kSteps);
        for (int i = 0; i < kSteps; ++i)
          work_mj += dot(guides.at(at(corner[side] + step * (i + 0.5))).force_n, step);
      }
      EXPECT_NEAR(work_mj, 0, 0.05) << kind_of(guide);
    }
  }
}

TEST(GuideModel, ATurningPathCreatesNoEnergy) {
  // Loops in the tip's position along a path whose axis tilts by 40 degrees, and in the tool's
  // tilt.
  const double most_rad = 40 * std::numbers::pi / 180;
  const auto tilted = [](double rad) { return Vec3{std::sin(rad), 0, std::cos(rad)}; };
  GuideModel guides = model(
      {.shape = PathGuide{
           .within_mm = 3,
           .axis_within_deg = 5,
           .turn_stiffness_nmm_per_rad = 100,
           .file = {},
           .paths = {{{.tip_mm = {0, 0, 0}}, {.tip_mm = {40, 0, 0}, .axis = tilted(most_rad)}}}}});
  constexpr int kSteps = 4000;
  const double corner[4][2] = {{0, 0}, {40, 0}, {40, most_rad}, {0, most_rad}};
  double work_mj = 0, given_mj = 0;
  for (int side = 0; side < 4; ++side) {
    const double *from = corner[side], *to = corner[(side + 1) % 4];
    const double dx = (to[0] - from[0]) / kSteps, dtilt = (to[1] - from[1]) / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      const Vec3 axis = tilted(from[1] + dtilt * (i + 0.5));
      const Wrench wrench = guides.at(at({from[0] + dx * (i + 0.5), 0, 0}, axis));
      const Vec3 turned{0, dtilt, 0};
      const Vec3 pivot_moved = Vec3{dx, 0, 0} + cross(turned, axis * kPivotMm);
      const double work = dot(wrench.force_n, pivot_moved) + dot(wrench.torque_nmm, turned);
      work_mj += work;
      given_mj += std::abs(work);
    }
  }
  EXPECT_NEAR(work_mj, 0, 0.01);
  EXPECT_GT(given_mj, 50) << "the test requires work";
}

TEST(GuideModel, TorqueHasNoStepBetweenTwoPaths) {
  GuideModel guides =
      model({.shape = PathGuide{
                 .within_mm = 3,
                 .axis_within_deg = 5,
                 .file = {},
                 .paths = {line({0, 0, 0}, {20, 0, 0}), line({20, 1, 0}, {0, 1, 0}, {1, 0, 0})}}});
  const Vec3 axis{0.6, 0, 0.8};
  const double before = guides.at(at({5, 0.4999, 0}, axis)).torque_nmm.y;
  EXPECT_NEAR(before, -60, 1e-9) << "toward +z";
  EXPECT_NEAR(guides.at(at({5, 0.5001, 0}, axis)).torque_nmm.y, before, 0.1);
  double last = before, widest = 0;
  for (int i = 0; i < 1000; ++i) {
    const double now = guides.at(at({5 + 0.01 * i, 1, 0}, axis)).torque_nmm.y;
    if (i > 0) widest = std::max(widest, std::abs(now - last));  // the tip moves by 0.5 mm at first
    last = now;
  }
  EXPECT_LT(widest, 0.6) << "1000 N mm/rad, 0.05 rad/mm, 0.01 mm";
  for (int i = 0; i < 3000; ++i) last = guides.at(at({15 - 0.005 * i, 1, 0}, axis)).torque_nmm.y;
  EXPECT_NEAR(last, 60, 1e-9) << "it has turned to the second path's axis";
}

TEST(GuideModel, GuidesShareTheStableTorsionalStiffness) {
  ServoSettings light = settings();
  light.passivity.inertia_kg_m2 = 2e-4;
  const auto torque = [&](std::size_t count, double tilt_rad, double rad_per_s) {
    const Guide guide{.shape = PathGuide{.axis_within_deg = 0,
                                         .turn_stiffness_nmm_per_rad = 1e5,
                                         .max_torque_nmm = 2000,
                                         .file = {},
                                         .paths = {line({0, 0, 0}, {20, 0, 0})}}};
    GuideModel guides(std::vector<Guide>(count, guide), light, 1);
    const Vec3 axis{std::sin(tilt_rad), 0, std::cos(tilt_rad)};
    return guides.at(at({10, 0, 0}, axis, {{}, {0, rad_per_s, 0}})).torque_nmm.y;
  };
  EXPECT_LT(torque(1, 1e-3, 0), -1);
  EXPECT_NEAR(torque(16, 1e-3, 0), torque(1, 1e-3, 0), 1e-9);
  const double damper = torque(1, 1e-3, 1) - torque(1, 1e-3, 0);
  EXPECT_LT(damper, -0.1);
  EXPECT_NEAR(torque(16, 1e-3, 1) - torque(16, 1e-3, 0), damper, 1e-9);
}

TEST(GuideModel, DeviceComesToRestOnATorsionalSpringWithAnyDamper) {
  constexpr double kInertia = 2e-4, kInertiaNmmS2 = 0.2, kTiltRad = 1e-4, kTurnRadPerS = 0.01;
  const Guide guide{.shape = PathGuide{.axis_within_deg = 0,
                                       .turn_stiffness_nmm_per_rad = 1e9,
                                       .max_torque_nmm = 1e6,
                                       .file = {},
                                       .paths = {line({0, 0, 0}, {20, 0, 0})}}};
  for (const double latency_s : {0.0, 0.001, 0.003}) {
    const LateLoop loop{latency_s, 100};
    ServoSettings device = settings();
    device.passivity.inertia_kg_m2 = kInertia;
    device.model.contact.force_delay_s = latency_s + kTickS / 2;
    device.model.contact.velocity_delay_s = latency_s + kTickS + loop.filter_s();
    const double best = best_damping(device.model.contact, kInertiaNmmS2);
    for (const double share : {1.0, 0.7, 0.4, 0.2}) {
      device.passivity.max_turn_damping = share * best;
      GuideModel guides({guide}, device, 1);
      const PastGrip tilted = at({10, 0, 0}, {std::sin(kTiltRad), 0, std::cos(kTiltRad)});
      PastGrip turning = tilted;
      turning.velocity.angular = {0, kTurnRadPerS, 0};
      const double spring = -guides.at(tilted).torque_nmm.y;
      const double damper = -guides.at(turning).torque_nmm.y - spring;
      EXPECT_GT(spring, 0);
      EXPECT_LT(worst_growth(kInertiaNmmS2, spring / kTiltRad, damper / kTurnRadPerS, loop), 1)
          << latency_s << " s, share " << share;
    }
  }
}

TEST(GuideModel, EqualMotionsGiveEqualBits) {
  GuidePath path;
  for (int i = 0; i < 3000; ++i)
    path.push_back({.tip_mm = {20 * std::cos(0.01 * i), 20 * std::sin(0.01 * i), 0.001 * i}});
  const Guide guide{
      .shape = PathGuide{.within_mm = 1, .axis_within_deg = 5, .file = {}, .paths = {path}}};
  GuideModel one = model(guide), other = model(guide);
  std::mt19937 random(9);
  std::normal_distribution<double> spread(0, 12);
  for (int i = 0; i < 500; ++i) {
    const PastGrip grip =
        at({spread(random), spread(random), spread(random)},
           normalized({spread(random), spread(random), 20}), {{spread(random), 0, 0}, {}});
    EXPECT_EQ(one.at(grip), other.at(grip));
  }
}

TEST(GuideModel, ReadsTheGuidesOfAWelcome) {
  const auto guides =
      guides_of(R"({"type":"welcome","guides":[{"kind":"depth","lowest_z_mm":-3}]})");
  ASSERT_TRUE(guides.has_value()) << guides.error();
  EXPECT_EQ(guide_notice(*guides, 1),
            "the session has guides: depth; strength 1, --guides 0 switches them off");
  EXPECT_TRUE(guides_of(R"({"type":"welcome"})")->empty());
  EXPECT_THAT(guides_of(R"({"guides":[{"kind":"depth","lowest_z_mm":"deep"}]})").error(),
              testing::HasSubstr("guides[0].lowest_z_mm must be a number"));
}

}  // namespace
}  // namespace kerf::agent::guide_model_test
