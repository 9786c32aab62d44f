// SPDX-License-Identifier: Apache-2.0
// The reference device's protocol without port and mailbox timeouts, which would otherwise hide a
// missing condition.
#include "haptic_agent/device/reference/reference_protocol.h"

#include "haptic_agent/realtime/clock.h"
#include "tests/support/test.h"
#include "tests/usb/model/reference_firmware.h"

namespace kerf::usb_test::reference_protocol_test {
namespace {

using agent::DevicePhase;
using agent::monotonic_us;
namespace ref = agent::reference;

/// Answers the identity request only.
class IdentityIo final : public agent::UsbSyncIo {
 public:
  std::expected<std::size_t, agent::UsbFault> control(const agent::ControlSetup&,
                                                      std::span<std::uint8_t> data) override {
    const auto bytes = ref::encode(ReferenceFirmware::standard().identity);
    std::ranges::copy(bytes, data.begin());
    return bytes.size();
  }
  std::expected<std::size_t, agent::UsbFault> read(std::span<std::uint8_t>, unsigned) override {
    return std::unexpected(agent::UsbFault::kTimeout);
  }
  std::expected<std::size_t, agent::UsbFault> write(std::span<const std::uint8_t>,
                                                    unsigned) override {
    return std::unexpected(agent::UsbFault::kTimeout);
  }
  std::uint8_t interface_number() const noexcept override { return 0; }
  bool stopping() const noexcept override { return false; }
};

class ReferenceProtocolAlone : public ::testing::Test {
 protected:
  void SetUp() override {
    IdentityIo introduction;
    ASSERT_TRUE(protocol.identify(introduction));
    protocol.connected(now_us);
  }
  /// Passes a report to the protocol: the pen upright at the center, homed, with additional status
  /// bits.
  bool report(std::uint16_t status, std::uint64_t at_us, double longer_mm = 0,
              std::uint16_t accepted = 0) {
    const auto pen = agent::standard_pen();
    const auto front = reach_for(pen.front, {0, 0, 0});
    const auto rear = reach_for(pen.rear, {0, 0, pen.length_mm + longer_mm});
    ref::StateReport state{.sequence = ++sequence};
    state.accepted = accepted;
    state.status = static_cast<std::uint16_t>(ref::kHomedMask | status);
    for (std::size_t i = 0; i < 3; ++i) {
      state.angles_urad[i] = static_cast<std::int32_t>(front[i] * 1e6);
      state.angles_urad[i + 3] = static_cast<std::int32_t>(rear[i] * 1e6);
    }
    return protocol.take(ref::encode(state), at_us);
  }
  /// Writes a force and composes the next command. Returns whether a torque is not zero.
  bool pulls() {
    protocol.mailbox().write({.force_n = {3, 0, 0}, .torque_nmm = {}});
    return composed().value_or(ref::CommandReport{}).torques_dnmm != Still{};
  }
  std::optional<ref::CommandReport> composed() {
    std::array<std::uint8_t, 64> packet{};
    const std::size_t bytes = protocol.compose(packet, now_us);
    return ref::decode_command(std::span(packet).first(bytes));
  }

  using Still = std::array<std::int16_t, 6>;
  /// Constant, so that no timeout expires unless a test advances it.
  const std::uint64_t now_us = monotonic_us();
  ref::ReferenceProtocol protocol{ref::PenPlace{}};
  std::uint16_t sequence = 0;
};

TEST_F(ReferenceProtocolAlone, ReportsPosesBetweenTheStepsOfItsJoints) {
  // Encoders of 4e-4 rad move the pen by about 0.06 mm a step. It moves by 5 mm/s.
  constexpr double kStepUrad = 400;
  const auto pen = agent::standard_pen();
  int moved = 0;
  Vec3 last{};
  for (int tick = 0; tick < 1000; ++tick) {
    const Vec3 at{0.005 * tick, 0.003 * tick, 0};
    const auto front = reach_for(pen.front, at);
    const auto rear = reach_for(pen.rear, at + Vec3{0, 0, pen.length_mm});
    ref::StateReport state{.sequence = ++sequence, .status = ref::kHomedMask};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto urad = [](double rad) {
        return static_cast<std::int32_t>(kStepUrad * std::round(rad * 1e6 / kStepUrad));
      };
      state.angles_urad[i] = urad(front[i]);
      state.angles_urad[i + 3] = urad(rear[i]);
    }
    const std::uint64_t at_us = now_us + static_cast<std::uint64_t>(tick + 1) * 1000;
    ASSERT_TRUE(protocol.take(ref::encode(state), at_us));
    const agent::DeviceState pose = protocol.mailbox().fetch(at_us);
    ASSERT_TRUE(pose.valid);
    if (tick >= 600 && length(pose.tip_mm - last - Vec3{0.005, 0.003, 0}) < 0.004) ++moved;
    last = pose.tip_mm;
  }
  EXPECT_GT(moved, 380) << "the pen moves evenly, in all reports";
}

TEST_F(ReferenceProtocolAlone, ForceIfAllConditionsHold) {
  EXPECT_FALSE(pulls()) << "there is no report yet";
  ASSERT_TRUE(report(0, now_us));
  EXPECT_TRUE(pulls());
}

TEST_F(ReferenceProtocolAlone, NoForceWithADeviceFault) {
  for (const std::uint16_t fault :
       {ref::kTooHotBit, ref::kOverCurrentBit, ref::kEmergencyStopBit, ref::kWatchdogBit}) {
    ASSERT_TRUE(report(0, now_us));
    ASSERT_TRUE(pulls());
    ASSERT_TRUE(report(fault, now_us));
    EXPECT_FALSE(pulls()) << fault;
  }
}

TEST_F(ReferenceProtocolAlone, NoForceForAnOldPose) {
  ASSERT_TRUE(report(0, now_us - agent::DeviceMailbox::kPoseLifeUs));
  EXPECT_FALSE(pulls());
  ASSERT_TRUE(report(0, now_us));
  EXPECT_TRUE(pulls());
}

TEST_F(ReferenceProtocolAlone, ForceEndsWithTheConnection) {
  ASSERT_TRUE(report(0, now_us));
  ASSERT_TRUE(pulls());
  protocol.disconnected();
  protocol.connected(now_us);
  ASSERT_TRUE(report(0, now_us));
  ASSERT_TRUE(composed());
  EXPECT_EQ(composed().value_or(ref::CommandReport{}).torques_dnmm, Still{});
  EXPECT_TRUE(pulls());
}

TEST_F(ReferenceProtocolAlone, EchoIsTheTimeFromACommandToTheFirstReportThatAcceptsIt) {
  ASSERT_TRUE(report(0, now_us));
  EXPECT_EQ(protocol.command_echo().count, 0U);
  const auto command = [this] {
    protocol.mailbox().write({});
    const auto sent = composed();
    EXPECT_TRUE(sent);
    return sent.value_or(ref::CommandReport{}).sequence;
  };
  const std::uint16_t first = command();
  ASSERT_TRUE(report(0, now_us + 1000, 0, static_cast<std::uint16_t>(first - 1)));
  EXPECT_EQ(protocol.command_echo().count, 0U) << "an earlier command";
  ASSERT_TRUE(report(0, now_us + 1700, 0, first));
  ASSERT_TRUE(report(0, now_us + 2700, 0, first));
  EXPECT_EQ(protocol.command_echo().count, 1U) << "repetitions do not count";
  EXPECT_EQ(protocol.command_echo().most_us, 1700U);
  const std::uint16_t second = command();
  ASSERT_TRUE(report(0, now_us + 900, 0, second));
  EXPECT_EQ(protocol.command_echo().count, 2U);
  EXPECT_EQ(protocol.command_echo().mean_us, 1300U);
  EXPECT_EQ(protocol.command_echo().most_us, 1700U);
  const std::uint16_t lost = command();
  protocol.disconnected();
  protocol.connected(now_us);
  ASSERT_TRUE(report(0, now_us + 500'000, 0, lost));
  EXPECT_EQ(protocol.command_echo().count, 2U) << "the device was away";
}

TEST_F(ReferenceProtocolAlone, InconsistentArmsAreRejected) {
  EXPECT_FALSE(report(0, now_us, 2.5));
  EXPECT_FALSE(pulls());
  EXPECT_TRUE(report(0, now_us, 1.5));
  EXPECT_TRUE(pulls());
}

}  // namespace
}  // namespace kerf::usb_test::reference_protocol_test
