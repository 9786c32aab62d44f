// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/mapping/block_settings.h"
#include "haptic_agent/servo/mapping/hand_mapping.h"
#include "haptic_agent/servo/servo_cycle.h"
#include "tests/support/test.h"

namespace kerf::agent::mapping_test {
namespace {

constexpr double kPivotMm = 60;

class Numbers {
 public:
  explicit Numbers(std::uint32_t seed) : random_(seed) {}
  double in(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vec3 any(double most) { return {in(-most, most), in(-most, most), in(-most, most)}; }
  WorkspaceMapping mapping() {
    return {.scale = std::exp(in(std::log(0.01), std::log(20))),
            .gain = std::exp(in(std::log(0.1), std::log(10))),
            .turn_rad = any(2),
            .device_mm = any(100),
            .block_mm = any(100)};
  }

 private:
  std::mt19937 random_;
};

/// A random grip of a device, with a motion that keeps the axis a unit vector.
PastGrip any_grip(Numbers& numbers) {
  const Vec3 axis = normalized(numbers.any(1));
  Vec3 turning = numbers.any(1);
  turning = turning - axis * dot(turning, axis);
  return {.grip = {numbers.any(50), axis}, .velocity = {numbers.any(100), turning}};
}
Vec3 tip_of(const PastGrip& grip, double pivot_mm) {
  return grip.grip.pivot_mm - grip.grip.axis * pivot_mm;
}
void expect_near(Vec3 a, Vec3 b, double error, const char* which = "") {
  EXPECT_NEAR(length(a - b), 0, error) << which;
}

TEST(SpaceMap, IdentityIsBitExact) {
  const SpaceMap map({.device_mm = {0.1, 0.2, 0.3}, .block_mm = {0.1, 0.2, 0.3}});
  EXPECT_TRUE(map.is_identity());
  const Vec3 odd{0.1 + 0.2, 1e-17, -1.0 / 3};
  EXPECT_EQ(map.to_block(odd), odd);
  EXPECT_EQ(map.to_device(odd), odd);
  EXPECT_EQ(map.to_device(Wrench{odd, odd}), (Wrench{odd, odd}));
}

TEST(SpaceMap, ReturnsFromTheBlockToTheSamePoint) {
  Numbers numbers(1);
  for (int i = 0; i < 100; ++i) {
    const SpaceMap map(numbers.mapping());
    const Vec3 at = numbers.any(80);
    expect_near(map.to_device(map.to_block(at)), at, 1e-9);
    expect_near(map.turned_to_device(map.turned_to_block(at)), at, 1e-12);
    EXPECT_NEAR(length(map.to_block(at) - map.to_block(Vec3{})), length(at) * map.mapping().scale,
                1e-9);
  }
}

TEST(SpaceMap, WorkAtTheHandScalesByGainOverScale) {
  Numbers numbers(2);
  for (int i = 0; i < 100; ++i) {
    const SpaceMap map(numbers.mapping());
    const PastGrip hand = any_grip(numbers);
    const Wrench block{numbers.any(5), numbers.any(200)};
    const double at_hand = work(map.to_device(block), hand.velocity);
    const double in_block = work(block, map.to_block(hand).velocity);
    EXPECT_NEAR(at_hand, in_block * map.mapping().gain / map.mapping().scale,
                1e-9 * (1 + std::abs(at_hand)));
  }
}

/// The tool in the block is the enlarged pen: the image of each point moves with it.
TEST(SpaceMap, ToolInTheBlockTurnsAboutTheSamePointAsThePen) {
  Numbers numbers(3);
  for (int i = 0; i < 50; ++i) {
    const SpaceMap map(numbers.mapping());
    const PastGrip hand = any_grip(numbers);
    const PastGrip tool = map.to_block(hand);
    expect_near(map.to_block(tip_of(hand, kPivotMm)), tip_of(tool, kPivotMm * map.mapping().scale),
                1e-9, "tip");
    const Vec3 arm = hand.grip.axis * -kPivotMm;
    expect_near(tool.velocity.at(tool.grip.axis * (-kPivotMm * map.mapping().scale)),
                map.turned_to_block(hand.velocity.at(arm)) * map.mapping().scale, 1e-6, "speed");
  }
}

TEST(SpaceMap, TorqueOfAnAnswerActsAtTheImageOfItsForce) {
  Numbers numbers(4);
  for (int i = 0; i < 50; ++i) {
    const SpaceMap map(numbers.mapping());
    const PastGrip hand = any_grip(numbers);
    const Vec3 axis = map.turned_to_block(hand.grip.axis);
    const Vec3 pivot = map.to_block(tip_of(hand, kPivotMm)) + axis * kPivotMm;
    const Vec3 at = numbers.any(30), force = numbers.any(5);
    ServerWrench answer{.wrench = {force, cross(at - pivot, force)}, .cut_centre_mm = at};
    const ServerWrench felt = map.to_device(answer, hand.grip.axis, kPivotMm);
    expect_near(felt.cut_centre_mm, map.to_device(at), 1e-9);
    expect_near(felt.wrench.force_n, map.turned_to_device(force) * map.mapping().gain, 1e-9);
    const Vec3 lever = felt.cut_centre_mm - hand.grip.pivot_mm;
    const Vec3 torque = cross(lever, felt.wrench.force_n);
    expect_near(felt.wrench.torque_nmm, torque, 1e-9 * (1 + length(torque)));
  }
}

TEST(SpaceMap, PlanesPushWithTheGainedForce) {
  const SpaceMap map({.scale = 0.04, .gain = 5, .turn_rad = {0, 0, std::numbers::pi / 2}});
  ServerWrench answer{.plane_count = 1};
  answer.planes[0] = {.point_mm = {0, 2, 0},
                      .normal = {0, 1, 0},
                      .depth_mm = 0.2F,
                      .stiffness_n_per_mm = 3,
                      .radius_mm = 1};
  const wire::ContactPlane plane = map.to_device(answer, {0, 0, 1}, kPivotMm).planes[0];
  expect_near(plane.point_mm, {50, 0, 0}, 1e-9);
  expect_near(Vec3(plane.normal), {1, 0, 0}, 1e-6);
  EXPECT_NEAR(plane.depth_mm, 5, 1e-5);
  EXPECT_NEAR(plane.radius_mm, 25, 1e-5);
  EXPECT_NEAR(plane.depth_mm * plane.stiffness_n_per_mm, 5 * 0.6, 1e-5) << "gain x force";
}

TEST(Fitted, StockFillsFourFifthsOfTheTightestEdge) {
  const SpaceBox workspace{{-60, -60, 0}, {60, 60, 80}}, tooth{{-1.5, -1, -2}, {1.5, 1, 0}};
  const auto fit = test::value_of(fitted(tooth, workspace, {.gain = 2}));
  EXPECT_NEAR(fit.scale, 3 / (0.8 * 120), 1e-12);
  EXPECT_EQ(fit.gain, 2);
  expect_near(SpaceMap(fit).to_block(Vec3{0, 0, 40}), {0, 0, -1}, 1e-12, "the middles meet");
  Numbers numbers(5);
  for (int i = 0; i < 50; ++i) {
    const SpaceBox stock{numbers.any(500) - Vec3{500, 500, 500},
                         numbers.any(500) + Vec3{510, 510, 510}};
    const SpaceMap map(*fitted(stock, workspace, {.turn_rad = numbers.any(3)}));
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 at = map.to_device(Vec3{(corner & 1) != 0 ? stock.min_mm.x : stock.max_mm.x,
                                         (corner & 2) != 0 ? stock.min_mm.y : stock.max_mm.y,
                                         (corner & 4) != 0 ? stock.min_mm.z : stock.max_mm.z});
      EXPECT_LE(std::abs(at.x), 48 + 1e-6);
      EXPECT_LE(std::abs(at.y), 48 + 1e-6);
      EXPECT_LE(std::abs(at.z - 40), 32 + 1e-6);
    }
  }
  EXPECT_FALSE(fitted(tooth, {}, {})) << "the workspace is unknown";
  EXPECT_FALSE(fitted(tooth, {{0, 0, 0}, {10, 10, 0}}, {})) << "a plane";
}

TEST(BlockSettings, LimitsInTheBlockMapToTheDevicesLimits) {
  const WorkspaceMapping mapping{.scale = 0.1, .gain = 4};
  ServoSettings device;
  device.model.contact = {
      .max_stiffness = 1.5, .max_damping = 0.004, .mass_kg = 0.1, .inertia_kg_m2 = 1e-4};
  const ServoSettings block = block_settings(device, mapping);
  const Vec3 normal{1, 0, 0};
  const Vec3 arm{0, 0, -kPivotMm};
  const ContactGains own = stable_gains(device.model.contact, 100, arm, normal, 1);
  const ContactGains seen = stable_gains(block.model.contact, 100, arm * mapping.scale, normal, 1);
  EXPECT_NEAR(seen.stiffness * mapping.stiffness_scale(), own.stiffness, 1e-12);
  EXPECT_NEAR(seen.damping * mapping.stiffness_scale(), own.damping, 1e-15);
  EXPECT_NEAR(block.pivot_mm, 6, 1e-12);
  EXPECT_NEAR(block.passivity.inertia_kg_m2 * mapping.torque_gain(), device.passivity.inertia_kg_m2,
              1e-18);
}

/// A hand whose device reports these poses, every millisecond.
class Hand {
 public:
  explicit Hand(const MappingSettings& settings) : mapping(settings) {}

  DeviceState at(Vec3 tip_mm, std::uint32_t buttons = wire::kButtonDeadman) {
    now_us += 1000;
    return mapping.follow({.tip_mm = tip_mm,
                           .axis = axis,
                           .buttons = buttons,
                           .time_us = now_us,
                           .valid = true,
                           .phase = DevicePhase::kReady},
                          now_us);
  }
  HandMapping mapping;
  Vec3 axis{0, 0, 1};
  std::uint64_t now_us = 1'000'000;
};

constexpr std::uint32_t kHeldCutting = wire::kButtonDeadman | wire::kButtonCutting;

TEST(HandMapping, ClutchKeepsTheToolAndResumesWithoutAJump) {
  Hand hand({.at_start = {.scale = 0.5, .device_mm = {10, 0, 0}, .block_mm = {1, 2, 3}}});
  const Vec3 before = hand.at({20, 0, 0}, kHeldCutting).tip_mm;
  expect_near(before, {6, 2, 3}, 1e-12);
  for (double x = 20; x >= -20; x -= 0.5) {
    const DeviceState tool = hand.at({x, 0.3 * x, 0}, kHeldCutting | kButtonClutch);
    EXPECT_EQ(tool.tip_mm, before) << "the tool stays";
    EXPECT_EQ(tool.buttons, wire::kButtonDeadman) << "it neither cuts nor is the clutch sent";
    EXPECT_TRUE(hand.mapping.is_away());
    EXPECT_EQ(hand.mapping.share(hand.now_us), 0);
  }
  // The first pose without the clutch continues the hand's motion.
  const DeviceState tool = hand.at({-19.8, -6, 0}, kHeldCutting);
  expect_near(tool.tip_mm, before + Vec3{0.1, 0, 0}, 1e-12);
  EXPECT_EQ(tool.buttons, kHeldCutting);
  EXPECT_TRUE(hand.mapping.has_resumed());
  const std::uint64_t resumed_us = hand.now_us;
  EXPECT_FALSE(hand.mapping.holds_for(resumed_us - 1));
  EXPECT_TRUE(hand.mapping.holds_for(resumed_us));
  double share = 0;
  for (int i = 0; i < 300; ++i) {
    hand.at({-19.8, -6, 0}, kHeldCutting);
    EXPECT_FALSE(hand.mapping.has_resumed());
    EXPECT_LE(hand.mapping.share(hand.now_us) - share, 0.00401) << "the force rises slowly";
    share = hand.mapping.share(hand.now_us);
  }
  EXPECT_EQ(share, 1);
}

TEST(HandMapping, AxisFollowsThePenWhileTheToolStays) {
  Hand hand({.at_start = {.turn_rad = {0, 0, std::numbers::pi / 2}}});
  hand.at({5, 0, 0});
  hand.axis = {0.6, 0, 0.8};
  const DeviceState tool = hand.at({9, 9, 9}, wire::kButtonDeadman | kButtonClutch);
  expect_near(tool.tip_mm, {0, 5, 0}, 1e-12);
  expect_near(tool.axis, {0, 0.6, 0.8}, 1e-12);
}

TEST(HandMapping, OtherButtonsOrTheReleasedDeadmanCanBeTheClutch) {
  for (const auto& [clutch, pressed] :
       {std::pair{ClutchButton::kUndo, wire::kButtonDeadman | kButtonUndo},
        std::pair{ClutchButton::kRedo, wire::kButtonDeadman | kButtonRedo},
        std::pair{ClutchButton::kDeadman, std::uint32_t{0}}}) {
    Hand hand({.clutch = clutch});
    EXPECT_EQ(hand.at({1, 0, 0}).tip_mm, (Vec3{1, 0, 0}));
    const DeviceState tool = hand.at({4, 0, 0}, pressed);
    EXPECT_EQ(tool.tip_mm, (Vec3{1, 0, 0}));
    EXPECT_EQ(tool.buttons & (kButtonUndo | kButtonRedo), 0U) << "it undoes nothing";
    expect_near(hand.at({4.5, 0, 0}).tip_mm, {1.5, 0, 0}, 1e-12);
  }
  Hand hand({});
  EXPECT_EQ(hand.at({0, 0, 0}, kButtonUndo).buttons, kButtonUndo);
  EXPECT_FALSE(hand.mapping.is_away());
}

TEST(HandMapping, ChangeKeepsTheToolOrPlacesIt) {
  Hand hand({});
  hand.at({10, 0, 0}, kHeldCutting);
  hand.mapping.change({.mapping = {.scale = 0.1, .turn_rad = {0, 0, 1}}});
  DeviceState tool = hand.at({10, 0, 0}, kHeldCutting);
  EXPECT_EQ(tool.tip_mm, (Vec3{10, 0, 0}));
  EXPECT_EQ(tool.buttons, wire::kButtonDeadman) << "the change itself cuts nothing";
  EXPECT_TRUE(hand.mapping.has_resumed());
  tool = hand.at({11, 0, 0}, kHeldCutting);
  EXPECT_EQ(tool.buttons, kHeldCutting);
  expect_near(tool.tip_mm, {10 + 0.1 * std::cos(1), 0.1 * std::sin(1), 0}, 1e-12);
  hand.mapping.change(
      {.mapping = {.device_mm = {11, 0, 0}, .block_mm = {7, 7, 7}}, .keeps_tool = false});
  EXPECT_EQ(hand.at({11, 0, 0}).tip_mm, (Vec3{7, 7, 7}));
}

TEST(HandMapping, AChangeWhileTheClutchIsHeldPlacesTheTool) {
  Hand hand({});
  hand.at({10, 0, 0});
  constexpr std::uint32_t kAway = wire::kButtonDeadman | kButtonClutch;
  hand.at({11, 0, 0}, kAway);
  hand.mapping.change(
      {.mapping = {.device_mm = {11, 0, 0}, .block_mm = {7, 7, 7}}, .keeps_tool = false});
  EXPECT_EQ(hand.at({11, 0, 0}, kAway).tip_mm, (Vec3{7, 7, 7}));
  EXPECT_EQ(hand.at({15, 0, 0}, kAway).tip_mm, (Vec3{7, 7, 7})) << "the clutch is still held";
  expect_near(hand.at({15.5, 0, 0}).tip_mm, {7.5, 7, 7}, 1e-12);
}

TEST(HandMapping, InvalidPosesDoNotChangeIt) {
  Hand hand({});
  hand.at({1, 0, 0});
  const double nan = std::nan("");
  hand.at({nan, 0, 0}, wire::kButtonDeadman | kButtonClutch);
  EXPECT_FALSE(hand.mapping.is_away());
  EXPECT_EQ(hand.at({2, 0, 0}).tip_mm, (Vec3{2, 0, 0}));
}

}  // namespace
}  // namespace kerf::agent::mapping_test
