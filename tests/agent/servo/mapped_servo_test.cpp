// SPDX-License-Identifier: Apache-2.0
// The servo behind a mapping: its limits and the bound of its energy are those of the hand.
#include "haptic_agent/servo/servo_cycle.h"
#include "tests/agent/stability/plant.h"
#include "tests/support/test.h"

namespace kerf::agent::mapped_servo_test {
namespace {

class NoListener final : public SampleListener {
 public:
  void sample_ready() noexcept override {}
};

/// A device in a hand that rests, then swings, with a server that answers each pose of the tool at
/// random: wrenches, cuts and planes at any depth that would overload the device. The user presses
/// buttons and clutch and changes the mapping at random.
class HostileBlock {
 public:
  HostileBlock(std::uint32_t seed, double scale, double gain)
      : random_(seed), seed_(seed), scale_(scale), gain_(gain) {
    const double swing_mm = in(5, 25), swing_hz = in(0.5, 3);
    plant_.emplace(
        [=](double time_s) {
          const double t = std::max(0.0, time_s - 0.3);
          const double x = swing_mm * std::sin(2 * std::numbers::pi * swing_hz * t);
          return Vec3{x, x / 2, -x / 3};
        },
        PlantMechanics{.mass_kg = log_in(0.05, 0.5),
                       .inertia_kg_m2 = log_in(1e-5, 1e-3),
                       .hand_n_per_mm = log_in(0.02, 1),
                       .hand_nmm_per_rad = log_in(20, 600),
                       .latency_us = seed % 3 * 1500},
        false);
    const ForceMode mode = seed % 2 == 0 ? ForceMode::kModel : ForceMode::kHold;
    ServoSettings settings = settings_for(plant_->capabilities(), {.mode = mode});
    settings.mapping.at_start = random_mapping();
    limits_ = settings.limits;
    cycle_.emplace(*plant_, samples_, wrenches_, listener_, settings);
  }

  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) tick(i);
  }

  double returned_mj() const { return plant_->most_returned_mj(); }
  double most_n = 0, most_nmm = 0;
  /// Greatest displacement of the tool beyond the scale times that of the device, mm.
  double jump_mm = 0;
  const WrenchLimits& limits() const { return limits_; }

 private:
  double in(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double log_in(double low, double high) { return std::exp(in(std::log(low), std::log(high))); }
  Vec3 any(double most) { return {in(-most, most), in(-most, most), in(-most, most)}; }
  WorkspaceMapping random_mapping() {
    return {.scale = scale_, .gain = gain_, .turn_rad = any(2), .block_mm = any(10)};
  }

  /// Returns a wrench that resists the tool for a while, then drives it, or pushes it anywhere.
  Wrench wanted(Vec3 moved_mm) {
    const double newtons = 20 / gain_;
    if (seed_ % 3 == 0) return pushed_;
    const double speed = std::max(1e-12, length(moved_mm));
    const bool drives = now_us_ % 300'000 > 200'000;
    const Vec3 force = moved_mm * ((drives ? newtons : -newtons / 4) / speed);
    return {force, cross(any(60), force)};
  }
  ServerWrench answer(const wire::MotionSample& sample, std::uint64_t now_us, Vec3 moved_mm) {
    ServerWrench answer{.wrench = wanted(moved_mm),
                        .pose_us = sample.time_us,
                        .arrival_us = now_us,
                        .engaged_area_mm2 = in(0, 1) < 0.5 ? 1.0 : 0.0,
                        .cut_centre_mm = sample.tip_mm + any(3 * scale_),
                        .plane_count = seed_ % 4 == 0 ? 2U : 0U};
    for (std::uint32_t i = 0; i < answer.plane_count; ++i) {
      answer.planes[i] = {.point_mm = sample.tip_mm,
                          .normal = Vec3f(normalized(any(1))),
                          .depth_mm = static_cast<float>(in(-1, 3) * scale_),
                          .stiffness_n_per_mm = static_cast<float>(10 / (gain_ * scale_)),
                          .radius_mm = static_cast<float>(20 * scale_),
                          .flags = wire::kContactStock};
    }
    return answer;
  }

  void tick(int i) {
    now_us_ += 1000;
    const bool calm = i < 150;
    if (i % 40 == 0) pushed_ = {any(20 / gain_), any(1000 / gain_)};
    if (!calm && i % 50 == 0) {
      std::uint32_t buttons = in(0, 1) < 0.7 ? wire::kButtonCutting : 0U;
      if (in(0, 1) < 0.2) buttons |= kButtonClutch;
      plant_->hold(buttons, 0);
    }
    if (!calm && in(0, 1) < 0.002) {
      cycle_->mapping_requests().write({.mapping = random_mapping()});
    }
    const Vec3 device_before = plant_->tip();
    cycle_->tick(now_us_);
    most_n = std::max(most_n, length(plant_->acting().force_n));
    most_nmm = std::max(most_nmm, length(plant_->acting().torque_nmm));
    wire::MotionSample sample;
    Vec3 moved_mm{};
    while (samples_.pop(sample)) {
      if (tool_mm_) moved_mm = sample.tip_mm - *tool_mm_;
      tool_mm_ = sample.tip_mm;
    }
    jump_mm = std::max(jump_mm, length(moved_mm) - scale_ * length(plant_->tip() - device_before));
    wrenches_.write(calm ? ServerWrench{.pose_us = sample.time_us, .arrival_us = now_us_}
                         : answer(sample, now_us_, moved_mm));
  }

  std::mt19937 random_;
  std::uint32_t seed_;
  double scale_, gain_;
  std::optional<Plant> plant_;
  WrenchLimits limits_;
  SampleRing samples_;
  LatestValue<ServerWrench> wrenches_;
  NoListener listener_;
  std::optional<ServoCycle> cycle_;
  std::optional<Vec3> tool_mm_;
  Wrench pushed_;
  std::uint64_t now_us_ = 1'000'000;
};

struct Strength {
  double scale, gain;
};

TEST(MappedServo, EnergyAndLimitsHoldAtTheHandForAnyScaleAndGain) {
  for (const auto [scale, gain] :
       {Strength{0.025, 1}, Strength{0.025, 40}, Strength{0.025, 0.1}, Strength{1, 1},
        Strength{1, 10}, Strength{8, 1}, Strength{8, 0.125}, Strength{8, 8}}) {
    double returned_mj = 0, most_n = 0;
    for (std::uint32_t seed = 1; seed <= 40; ++seed) {
      HostileBlock block(seed, scale, gain);
      block.run(2000);
      const std::string which = "scale " + std::to_string(scale) + ", gain " +
                                std::to_string(gain) + ", seed " + std::to_string(seed);
      EXPECT_LE(block.returned_mj(), PassivitySettings{}.tank_mj) << which;
      EXPECT_LE(block.most_n, block.limits().force_n * (1 + 1e-9)) << which;
      EXPECT_LE(block.most_nmm, block.limits().torque_nmm * (1 + 1e-9)) << which;
      EXPECT_LE(block.jump_mm, 1e-6 * scale) << which << ": the tool jumps";
      returned_mj = std::max(returned_mj, block.returned_mj());
      most_n = std::max(most_n, block.most_n);
    }
    EXPECT_GT(returned_mj, 3) << scale << ", " << gain << ": the test requires returned energy";
    EXPECT_GT(most_n, 4) << "and strong forces";
  }
}

/// A device at rest that a test moves, behind a mapping.
class Moved final : public HapticDevice {
 public:
  DeviceCapabilities capabilities() const override {
    return {.name = "moved",
            .max_force_n = 20,
            .max_torque_nmm = 500,
            .workspace_min_mm = {-60, -60, -60},
            .workspace_max_mm = {60, 60, 60}};
  }
  DeviceState read(std::uint64_t now_us) noexcept override {
    state.time_us = now_us;
    return state;
  }
  void write(const Wrench& wrench) noexcept override { output = wrench; }
  void stop() noexcept override {}
  DeviceState state{.buttons = wire::kButtonDeadman, .valid = true, .phase = DevicePhase::kReady};
  Wrench output;
};

class MappedServoTest : public ::testing::Test {
 protected:
  void make(const WorkspaceMapping& mapping, ForceMode mode = ForceMode::kHold) {
    ServoSettings settings = settings_for(device.capabilities(), {.mode = mode});
    // So heavy that the energy of a few ticks suffices.
    settings.passivity.mass_kg = 10;
    settings.passivity.inertia_kg_m2 = 1;
    settings.mapping.at_start = mapping;
    cycle.emplace(device, samples, wrenches, listener, settings);
    cycle->tell_reach(reach);
  }
  /// Moves the hand by `step_mm` in each tick, against `force_n` of the block.
  void run(int ticks, Vec3 step_mm = {}, Vec3 force_n = {}) {
    for (int i = 0; i < ticks; ++i) {
      now_us += 1000;
      device.state.tip_mm = device.state.tip_mm + step_mm;
      wrenches.write({.wrench = {force_n, cross(Vec3{0, 0, -60}, force_n)},
                      .pose_us = now_us - 1000,
                      .arrival_us = now_us});
      cycle->tick(now_us);
      while (samples.pop(sample)) {
      }
    }
  }
  Moved device;
  SampleRing samples;
  LatestValue<ServerWrench> wrenches;
  LatestValue<Reach> reach;
  NoListener listener;
  std::optional<ServoCycle> cycle;
  wire::MotionSample sample;
  std::uint64_t now_us = 1'000'000;
};

TEST_F(MappedServoTest, HandFeelsTheGainedForceAtItsOwnLever) {
  make({.scale = 0.04, .gain = 2, .turn_rad = {0, 0, std::numbers::pi / 2}});
  run(200);
  run(800, {0, 0.03, 0}, {1, 0, 0});
  // Device +y moves the tool along the block's -x. The force of the block holds it back.
  EXPECT_NEAR(sample.tip_mm.x, -0.04 * 24, 1e-9);
  EXPECT_NEAR(sample.tip_mm.y, 0, 1e-9);
  EXPECT_NEAR(device.output.force_n.y, -2, 1e-9);
  EXPECT_NEAR(device.output.force_n.x, 0, 1e-9);
  // A force at the tip is 60 mm from the hand at any scale.
  EXPECT_NEAR(device.output.torque_nmm.x, -120, 1e-6);
}

TEST_F(MappedServoTest, SupervisorWatchesTheHandInItsOwnSpace) {
  // 0.3 m/s of the hand are 2.4 m/s of the tool, and the tool leaves the range of the device's
  // workspace.
  make({.scale = 8});
  run(700);
  EXPECT_EQ(cycle->supervisor().phase(), ServoPhase::kActive);
  run(150, {0.3, 0, 0});
  EXPECT_NEAR(sample.tip_mm.x, 360, 1e-6);
  EXPECT_EQ(cycle->supervisor().trips(), 0U);
  run(60, {0.3, 0, 0});
  EXPECT_EQ(cycle->supervisor().code(), TripCode::kWorkspace);
}

TEST_F(MappedServoTest, FastHandTripsEvenIfTheToolIsSlow) {
  make({.scale = 0.025});
  run(700);
  run(40, {1.2, 0, 0});
  EXPECT_EQ(cycle->supervisor().code(), TripCode::kSpeed);
}

TEST_F(MappedServoTest, ForceEndsWithTheClutchAndRisesAfterIt) {
  make({.scale = 0.5});
  run(200);
  run(800, {0, 0, -0.01}, {0, 0, 2});
  EXPECT_NEAR(device.output.force_n.z, 2, 1e-9);
  const Vec3 held = sample.tip_mm;
  device.state.buttons |= kButtonClutch;
  run(1, {0, 0, 0.2}, {0, 0, 2});
  EXPECT_EQ(device.output, Wrench{});
  run(100, {0, 0, 0.2}, {0, 0, 2});
  EXPECT_EQ(sample.tip_mm, held);
  EXPECT_EQ(sample.buttons & kButtonClutch, 0U);
  device.state.buttons &= ~kButtonClutch;
  double last = 0;
  for (int i = 0; i < 260; ++i) {
    run(1, {0, 0, -0.01}, {0, 0, 2});
    EXPECT_LE(device.output.force_n.z - last, 2 * 0.0041);
    last = device.output.force_n.z;
  }
  EXPECT_NEAR(last, 2, 1e-9);
  EXPECT_NEAR(sample.tip_mm.z, held.z - 0.5 * 2.6, 1e-9) << "from where it stayed";
}

TEST_F(MappedServoTest, AnswersFromBeforeTheClutchAreNotRenderedInAnyMode) {
  for (const ForceMode mode :
       {ForceMode::kModel, ForceMode::kInterpolated, ForceMode::kHold, ForceMode::kPaper}) {
    SCOPED_TRACE(to_string(mode));
    make({}, mode);
    run(700);
    const auto answer = [this](std::uint64_t pose_us) {
      ServerWrench push{.wrench = {{0, 0, 1}, {}}, .pose_us = pose_us, .arrival_us = now_us};
      push.plane_count = 1;
      push.planes[0] = {.point_mm = device.state.tip_mm,
                        .normal = {0, 0, 1},
                        .depth_mm = 1,
                        .stiffness_n_per_mm = 1,
                        .radius_mm = 50,
                        .flags = wire::kContactObstacle};
      wrenches.write(push);
      now_us += 1000;
      device.state.tip_mm.z -= 0.01;
      cycle->tick(now_us);
    };
    for (int i = 0; i < 20; ++i) answer(now_us);
    device.state.buttons |= kButtonClutch;
    run(10, {0, 0, 0.2});
    const std::uint64_t clutched_us = now_us;
    device.state.buttons &= ~kButtonClutch;
    for (int i = 0; i < 300; ++i) {
      answer(clutched_us);
      EXPECT_EQ(device.output, Wrench{}) << "tick " << i;
    }
    for (int i = 0; i < 300; ++i) answer(now_us);
    EXPECT_GT(device.output.force_n.z, 0.1) << "answers to poses after it are";
  }
}

TEST_F(MappedServoTest, ReportsTheWorkspaceAtTheStartAndAfterTheClutch) {
  make({.scale = 0.1, .turn_rad = {0, 0, 1}, .block_mm = {1, 0, 0}});
  run(1);
  Reach reported;
  ASSERT_TRUE(reach.read(reported));
  EXPECT_EQ(reported, (Reach{{1, 0, 0}, {6, 6, 6}, {0, 0, 1}, 0.1}));
  run(100);
  EXPECT_FALSE(reach.read(reported)) << "nothing has changed";
  device.state.buttons |= kButtonClutch;
  run(100, {0, 0, 0.1});
  EXPECT_FALSE(reach.read(reported)) << "it moves";
  device.state.buttons &= ~kButtonClutch;
  run(1);
  ASSERT_TRUE(reach.read(reported));
  EXPECT_NEAR(reported.center_mm.z, -1, 1e-9);
}

}  // namespace
}  // namespace kerf::agent::mapped_servo_test
