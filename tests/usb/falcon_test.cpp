// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/falcon/falcon_firmware.h"
#include "haptic_agent/device/falcon/falcon_protocol.h"
#include "server/wire/types.h"
#include "tests/support/test.h"
#include "tests/usb/model/falcon_model.h"
#include "tests/usb/rig.h"

namespace kerf::usb_test::falcon_test {
namespace {

using agent::DevicePhase;
using agent::UsbHapticDevice;
namespace falcon = agent::falcon;

TEST(FalconKinematics, ForwardInvertsInverse) {
  int within = 0;
  for (double x = -50; x <= 50; x += 12.5) {
    for (double y = -50; y <= 50; y += 12.5) {
      for (double z = 85; z <= 165; z += 10) {
        const auto angles = falcon::leg_angles({x, y, z});
        if (!angles) continue;
        ++within;
        const auto position = falcon::position_of(*angles, falcon::kMiddleMm);
        ASSERT_TRUE(position) << x << ' ' << y << ' ' << z;
        ASSERT_LT(length(*position - Vec3{x, y, z}), 1e-6);
      }
    }
  }
  EXPECT_GT(within, 650);
}

TEST(FalconKinematics, TorquesDoTheWorkOfTheForce) {
  std::mt19937 engine{3};
  std::uniform_real_distribution<double> unit{-1, 1};
  constexpr double kStepMm = 1e-5;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 at{40 * unit(engine), 40 * unit(engine), 125 + 35 * unit(engine)};
    const Vec3 direction{unit(engine), unit(engine), unit(engine)};
    const Vec3 force{8 * unit(engine), 8 * unit(engine), 8 * unit(engine)};
    const auto angles = falcon::leg_angles(at);
    const auto before = falcon::leg_angles(at - direction * kStepMm);
    const auto after = falcon::leg_angles(at + direction * kStepMm);
    ASSERT_TRUE(angles && before && after);
    const auto torques = test::value_of(falcon::leg_torques(*angles, at, force));
    double by_motors = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      by_motors += (torques)[j] * ((*after)[j] - (*before)[j]) / (2 * kStepMm);
    }
    ASSERT_NEAR(by_motors, dot(force, direction), 1e-4);
  }
}

TEST(FalconKinematics, ImpossibleAnglesHaveNoPosition) {
  EXPECT_FALSE(falcon::leg_angles({0, 0, 400}));
  EXPECT_FALSE(falcon::position_of({std::nan(""), 0, 0}, falcon::kMiddleMm));
}

TEST(FalconFrame, LimitedWordsKeepTheDirection) {
  EXPECT_EQ(falcon::motor_words({1, -2, 0}), (std::array<std::int16_t, 3>{-10, 20, 0}));
  const auto most = falcon::motor_words({30'000, -15'000, 3000});
  EXPECT_EQ(most, (std::array<std::int16_t, 3>{-4096, 2048, -410}));
  EXPECT_EQ(falcon::motor_words({1e300, -1e300, 0}), (std::array<std::int16_t, 3>{-4096, 4096, 0}));
  EXPECT_EQ(falcon::motor_words({std::nan(""), 1, 1}), (std::array<std::int16_t, 3>{}));
  const auto frame = falcon::encode_command({0x1234, -1, -32768}, falcon::kGreenLight);
  const std::string text(frame.begin(), frame.end());
  EXPECT_EQ(text, "<EDCBPPPPAAAICA>");
}

TEST(FalconFrame, StatusBytesAreSkippedAndFramesAssembled) {
  const falcon::FalconState state{.encoders = {-1, 2, 300}, .buttons = 4, .homed = 7};
  const auto frame = falcon::encode_state(state);
  falcon::FrameReader reader;
  EXPECT_FALSE(reader.take(std::array<std::uint8_t, 2>{1, 0x60}));
  Bytes first{1, 0x60, 'x', 'y'}, second{1, 0x60};
  first.insert(first.end(), frame.begin(), frame.begin() + 7);
  second.insert(second.end(), frame.begin() + 7, frame.end());
  EXPECT_FALSE(reader.take(first));
  EXPECT_EQ(falcon::decode_state(test::value_of(reader.take(second))), state);
}

TEST(FalconProtocol, ReportsPosesBetweenTheCountsOfItsLegs) {
  falcon::FalconProtocol protocol({.middle_mm = {0, 0, 10}});
  int moved = 0, repeated = 0;
  Vec3 last{};
  for (std::uint64_t tick = 1; tick <= 400; ++tick) {
    // Each leg counts in every tenth report. The grip moves by 4 mm/s.
    const auto count = static_cast<std::int16_t>(tick / 10);
    const falcon::FalconState state{.encoders = {count, count, count}, .homed = 7};
    Bytes packet{1, 0x60};
    const auto frame = falcon::encode_state(state);
    packet.insert(packet.end(), frame.begin(), frame.end());
    const std::uint64_t now_us = 1'000'000 + tick * 1000;
    ASSERT_TRUE(protocol.take(packet, now_us));
    const agent::DeviceState pose = protocol.mailbox().fetch(now_us);
    ASSERT_TRUE(pose.valid);
    if (tick > 100) (length(pose.tip_mm - last) > 0.001 ? moved : repeated)++;
    last = pose.tip_mm;
  }
  EXPECT_GT(moved, 290) << "one in ten reports has a new count";
  EXPECT_LT(repeated, 10);
}

class Falcon : public ::testing::Test {
 protected:
  static std::unique_ptr<UsbHapticDevice> make(Rig<FalconModel>& rig, Bytes firmware = {}) {
    return std::make_unique<UsbHapticDevice>(
        std::make_unique<falcon::FalconProtocol>(
            falcon::FalconSettings{.middle_mm = {0, 0, 10}, .firmware = std::move(firmware)}),
        rig.settings());
  }
};

TEST_F(Falcon, NoForceBeforeAllLegsAreHomed) {
  Rig<FalconModel> rig(FalconModel::Settings{.homing_answers = 100});
  const auto device = make(rig);
  bool pulled_early = false, saw_homing = false;
  EXPECT_TRUE(eventually([&] {
    const auto state = device->read(agent::monotonic_us());
    device->write({.force_n = {4, 0, 0}, .torque_nmm = {}});
    saw_homing = saw_homing || state.phase == DevicePhase::kHoming;
    return rig.query([&](FalconModel& model) {
      const bool pulls = model.motors() != std::array<std::int16_t, 3>{};
      pulled_early = pulled_early || (pulls && !model.homed());
      return pulls;
    });
  }));
  EXPECT_TRUE(saw_homing);
  EXPECT_FALSE(pulled_early);
  EXPECT_TRUE(rig.notices.has("until its light turns"));
  EXPECT_EQ(rig.query([](FalconModel& model) { return model.lights(); }), falcon::kGreenLight);
}

TEST_F(Falcon, ReportsTheGripPosition) {
  Rig<FalconModel> rig;
  const auto device = make(rig);
  ASSERT_TRUE(eventually([&] { return is_ready(*device); }));
  rig.query([](FalconModel& model) {
    model.hold(falcon::kMiddleMm + Vec3{5, -3, 8});
    model.press(falcon::kCenterButton);
    return 0;
  });
  // From the Falcon's axes to Kerf's: right is right, up is up, towards the user is -y.
  const Vec3 tip{5, -8, 10 - 3};
  agent::DeviceState state;
  EXPECT_TRUE(eventually([&] {
    state = device->read(agent::monotonic_us());
    return state.valid && length(state.tip_mm - tip) < 0.1;
  }));
  EXPECT_EQ(state.axis, (Vec3{0, 0, 1}));
  EXPECT_EQ(state.buttons, wire::kButtonCutting | wire::kButtonDeadman);
  for (const std::uint8_t small : {std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{8}}) {
    rig.query([small](FalconModel& model) {
      model.press(small);
      return 0;
    });
    EXPECT_TRUE(eventually([&] {
      return device->read(agent::monotonic_us()).buttons ==
             (wire::kButtonDeadman | agent::kButtonClutch);
    }));
  }
}

TEST_F(Falcon, SendsOneCommandPerAnswer) {
  Rig<FalconModel> rig;
  rig.query([](FalconModel& model) { return model.split_answers(true), 0; });
  const auto device = make(rig);
  ASSERT_TRUE(eventually([&] { return is_ready(*device); }));
  for (int i = 0; i < 300; ++i) {
    device->write({.force_n = {0, 0, 2}, .torque_nmm = {}});
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  EXPECT_EQ(rig.query([](FalconModel& model) { return model.impatient_commands(); }), 0);
}

TEST_F(Falcon, FirmwareLoadingIsRetried) {
  Rig<FalconModel> rig(FalconModel::Settings{.has_firmware = false,
                                             .firmware_bytes = 300,
                                             .ignored_wake_requests = 3,
                                             .garbled_loads = 2});
  const auto device = make(rig, Bytes(300, 0x5A));
  EXPECT_TRUE(eventually([&] { return is_ready(*device); }));
  EXPECT_EQ(rig.query([](FalconModel& model) { return model.loads(); }), 3);
}

TEST_F(Falcon, MissingFirmwareNamesTheOption) {
  Rig<FalconModel> rig(FalconModel::Settings{.has_firmware = false});
  const auto device = make(rig);
  EXPECT_TRUE(eventually([&] { return rig.notices.has("--device falcon:FILE"); }));
}

TEST_F(Falcon, HangingFirmwareIsNotReady) {
  Rig<FalconModel> rig;
  const auto device = make(rig);
  ASSERT_TRUE(eventually([&] { return is_ready(*device); }));
  rig.query([](FalconModel& model) { return model.hang(true), 0; });
  EXPECT_TRUE(eventually([&] { return !device->read(agent::monotonic_us()).valid; }));
  EXPECT_TRUE(eventually([&] { return !is_ready(*device); }));
  rig.query([](FalconModel& model) { return model.hang(false), 0; });
  EXPECT_TRUE(eventually([&] { return is_ready(*device); }));
}

TEST_F(Falcon, HomesAgainAfterReplugging) {
  Rig<FalconModel> rig;
  const auto device = make(rig);
  ASSERT_TRUE(eventually([&] { return is_ready(*device); }));
  rig.bus.unplug();
  EXPECT_TRUE(eventually([&] { return !is_ready(*device); }));
  rig.bus.plug();
  EXPECT_TRUE(eventually([&] { return is_ready(*device); }));
}

/// The protocol without a port, at a constant time.
class FalconProtocolAlone : public ::testing::Test {
 protected:
  void SetUp() override { protocol.connected(now_us); }
  /// Passes an answer with this grip position to the protocol.
  bool answer(Vec3 position_mm, std::uint64_t at_us, std::uint8_t homed = falcon::kAllHomed) {
    falcon::FalconState state{.homed = homed};
    const auto angles = falcon::leg_angles(position_mm).value();
    for (std::size_t i = 0; i < 3; ++i) state.encoders[i] = falcon::count_of(angles[i]);
    const auto frame = falcon::encode_state(state);
    Bytes packet{1, 0x60};
    packet.insert(packet.end(), frame.begin(), frame.end());
    return protocol.take(packet, at_us);
  }
  bool pulls() {
    protocol.mailbox().write({.force_n = {4, 0, 0}, .torque_nmm = {}});
    std::array<std::uint8_t, 64> packet{};
    const std::size_t bytes = protocol.compose(packet, now_us);
    const auto command = falcon::decode_command(std::span(packet).first(bytes));
    return command.value().motors != std::array<std::int16_t, 3>{};
  }

  const std::uint64_t now_us = agent::monotonic_us();
  falcon::FalconProtocol protocol{{}};
};

TEST_F(FalconProtocolAlone, NoForceForAnOldPose) {
  ASSERT_TRUE(answer(falcon::kMiddleMm, now_us - agent::DeviceMailbox::kPoseLifeUs));
  EXPECT_FALSE(pulls());
  ASSERT_TRUE(answer(falcon::kMiddleMm, now_us));
  EXPECT_TRUE(pulls());
}

TEST_F(FalconProtocolAlone, ForceOnlyIfAllLegsAreHomed) {
  for (const int some : {0, 1, 3, 5, 6}) {
    ASSERT_TRUE(answer(falcon::kMiddleMm, now_us, static_cast<std::uint8_t>(some)));
    EXPECT_FALSE(pulls()) << some;
    ASSERT_TRUE(answer(falcon::kMiddleMm, now_us));
    EXPECT_TRUE(pulls());
  }
}

TEST_F(FalconProtocolAlone, ImplausibleJumpIsRejected) {
  ASSERT_TRUE(answer(falcon::kMiddleMm, now_us));
  EXPECT_FALSE(answer(falcon::kMiddleMm + Vec3{30, 0, 0}, now_us + 1000));
  EXPECT_TRUE(answer(falcon::kMiddleMm + Vec3{0.5, 0, 0}, now_us + 2000));
}

TEST(FalconFirmware, UnreadableFileIsRejected) {
  EXPECT_FALSE(falcon::read_firmware("/no/such/file"));
  EXPECT_FALSE(falcon::read_firmware("/dev/null"));
}

}  // namespace
}  // namespace kerf::usb_test::falcon_test
