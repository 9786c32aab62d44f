// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "haptic_agent/device/reference/reference_protocol.h"
#include "server/wire/types.h"
#include "tests/usb/model/reference_firmware.h"
#include "tests/usb/rig.h"

namespace kerf::usb_test {
namespace {

using agent::DevicePhase;
using agent::UsbHand;
namespace ref = agent::reference;

constexpr ref::PenPlace kPlace{.middle_mm = {10, 20, 30}, .pivot_mm = 60};

class ReferenceDevice : public ::testing::Test {
 protected:
  std::unique_ptr<UsbHand> make() {
    return std::make_unique<UsbHand>(std::make_unique<ref::ReferenceProtocol>(kPlace),
                                     rig.settings());
  }
  double greatest_torque() {
    return rig.ask([](ReferenceFirmware& firmware) {
      double most = 0;
      for (const double t : firmware.motors_nmm(agent::monotonic_us())) {
        most = std::max(most, std::abs(t));
      }
      return most;
    });
  }
  /// Writes as the servo does, until the motors do as expected.
  template <typename Condition>
  bool write_until(UsbHand& hand, const Wrench& wrench, Condition condition) {
    return eventually([&] {
      hand.read(agent::monotonic_us());
      hand.write(wrench);
      return condition();
    });
  }
  bool pulls() { return greatest_torque() > 50; }
  bool rests() { return greatest_torque() == 0; }

  Rig<ReferenceFirmware> rig;
  const Wrench push{.force_n = {3, 0, 0}, .torque_nmm = {}};
};

TEST_F(ReferenceDevice, HomesAndThenTellsThePensPose) {
  const auto hand = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*hand); }));
  const Vec3 axis = normalized({0.2, -0.1, 1});
  const Vec3 grip{5, -7, 52};
  rig.ask([&](ReferenceFirmware& firmware) {
    firmware.hold(grip, axis);
    firmware.press(ref::kCutButton | ref::kGripSensor);
    return 0;
  });
  // The grip's middle is where the tool's tip, held upright, is at the middle of the workspace.
  const Vec3 tip = kPlace.middle_mm + Vec3{0, 0, 60} + grip - Vec3{0, 0, 40} - axis * 60;
  agent::DeviceState state;
  EXPECT_TRUE(eventually([&] {
    state = hand->read(agent::monotonic_us());
    return length(state.tip_mm - tip) < 0.01 && state.valid;
  }));
  EXPECT_LT(length(state.axis - axis), 1e-4);
  EXPECT_EQ(state.buttons, wire::kButtonCutting | wire::kButtonDeadman);
  EXPECT_TRUE(hand->trouble().empty());
}

TEST_F(ReferenceDevice, ShowsNoForceBeforeItIsHomed) {
  auto slow = ReferenceFirmware::standard();
  slow.homing_us = 200'000;
  Rig<ReferenceFirmware> slow_rig(slow);
  UsbHand hand(std::make_unique<ref::ReferenceProtocol>(kPlace), slow_rig.settings());
  ASSERT_TRUE(
      eventually([&] { return hand.read(agent::monotonic_us()).phase == DevicePhase::kHoming; }));
  bool pulled_early = false;
  EXPECT_TRUE(eventually([&] {
    const auto state = hand.read(agent::monotonic_us());
    hand.write(push);
    slow_rig.ask([&](ReferenceFirmware& firmware) {
      const auto motors = firmware.motors_nmm(agent::monotonic_us());
      const bool any = std::ranges::any_of(motors, [](double t) { return t != 0; });
      pulled_early = pulled_early || (any && !firmware.homed());
      return 0;
    });
    EXPECT_FALSE(state.valid && state.phase == DevicePhase::kHoming);
    return state.phase == DevicePhase::kReady;
  }));
  EXPECT_FALSE(pulled_early);
}

TEST_F(ReferenceDevice, ShowsTheWrenchByVirtualWork) {
  const auto hand = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*hand); }));
  ASSERT_TRUE(write_until(*hand, push, [&] { return pulls(); }));
  // Each motor's torque is the work that the force does where that motor alone turns a little.
  const auto pen = agent::standard_pen();
  const agent::PenAngles q{reach_for(pen.front, {0, 0, 0}), reach_for(pen.rear, {0, 0, 80})};
  const auto shown = rig.ask(
      [](ReferenceFirmware& firmware) { return firmware.motors_nmm(agent::monotonic_us()); });
  constexpr double kTurn = 1e-6;
  for (std::size_t i = 0; i < 3; ++i) {
    auto front = q.front, rear = q.rear;
    front[i] += kTurn;
    rear[i] += kTurn;
    const double by_front = agent::arm_point(pen.front, front).x / kTurn;
    const double by_rear = agent::arm_point(pen.rear, rear).x / kTurn;
    EXPECT_NEAR(shown[i], 1.5 * by_front, 0.3);
    EXPECT_NEAR(shown[i + 3], 1.5 * by_rear, 0.3);
  }
}

TEST_F(ReferenceDevice, StopTakesTheForceAwayWithoutTheServo) {
  const auto hand = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*hand); }));
  ASSERT_TRUE(write_until(*hand, push, [&] { return pulls(); }));
  hand->write(push);
  std::thread watchdog([&] { hand->stop(); });
  watchdog.join();
  EXPECT_TRUE(eventually([&] { return rests(); }));
  EXPECT_TRUE(write_until(*hand, push, [&] { return pulls(); }));
}

TEST_F(ReferenceDevice, ForceEndsByItselfWhenTheServoNoLongerWrites) {
  const auto hand = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*hand); }));
  ASSERT_TRUE(write_until(*hand, push, [&] { return pulls(); }));
  EXPECT_TRUE(eventually([&] { return rests(); }));
  // The driver did it, not the firmware's watchdog: commands went on.
  EXPECT_FALSE(rig.ask([](ReferenceFirmware& firmware) { return firmware.watchdog_tripped(); }));
}

TEST_F(ReferenceDevice, FirmwaresWatchdogEndsTheForceOfAHostThatHangs) {
  const auto hand = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*hand); }));
  ASSERT_TRUE(write_until(*hand, push, [&] { return pulls(); }));
  rig.bus.hold_out(true);
  EXPECT_TRUE(write_until(*hand, push, [&] {
    return rig.ask([](ReferenceFirmware& firmware) {
      firmware.motors_nmm(agent::monotonic_us());
      return firmware.watchdog_tripped();
    });
  }));
  EXPECT_TRUE(rests());
  rig.bus.hold_out(false);
  EXPECT_TRUE(write_until(*hand, push, [&] { return pulls(); }));
}

TEST_F(ReferenceDevice, ClosingTakesTheForceAway) {
  auto hand = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*hand); }));
  ASSERT_TRUE(write_until(*hand, push, [&] { return pulls(); }));
  hand.reset();
  EXPECT_TRUE(eventually([&] { return rests(); }));
  // The driver said so; the firmware had no need to find out.
  EXPECT_FALSE(rig.ask([](ReferenceFirmware& firmware) { return firmware.watchdog_tripped(); }));
}

TEST_F(ReferenceDevice, AWrenchThatIsNotFiniteGivesNone) {
  const auto hand = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*hand); }));
  ASSERT_TRUE(write_until(*hand, push, [&] { return pulls(); }));
  const Wrench broken{.force_n = {std::nan(""), 0, 0}, .torque_nmm = {}};
  EXPECT_TRUE(write_until(*hand, broken, [&] { return rests(); }));
}

TEST_F(ReferenceDevice, FaultsOfItsOwnKeepItFromBeingReady) {
  const auto hand = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*hand); }));
  for (const auto& [bit, words] : {std::pair{ref::kEmergencyStopBit, "emergency stop"},
                                   {ref::kTooHotBit, "too hot"},
                                   {ref::kOverCurrentBit, "too much current"}}) {
    rig.ask([&, bit = bit](ReferenceFirmware& firmware) { return firmware.fail(bit), 0; });
    EXPECT_TRUE(eventually([&] { return !is_ready(*hand); })) << words;
    EXPECT_TRUE(eventually([&, words = words] {
      return hand->trouble().find(words) != std::string::npos;
    })) << words;
    rig.ask([](ReferenceFirmware& firmware) { return firmware.fail(0), 0; });
    EXPECT_TRUE(eventually([&] { return is_ready(*hand); })) << words;
  }
}

TEST_F(ReferenceDevice, AnotherVersionIsNamedAndRejected) {
  auto settings = ReferenceFirmware::standard();
  settings.identity.version = 2;
  Rig<ReferenceFirmware> other(settings);
  UsbHand hand(std::make_unique<ref::ReferenceProtocol>(kPlace), other.settings());
  EXPECT_TRUE(eventually([&] { return other.notices.has("version 2 of the protocol"); }));
  EXPECT_EQ(hand.read(agent::monotonic_us()).phase, DevicePhase::kClosed);
}

TEST_F(ReferenceDevice, ASlowWatchdogIsRejected) {
  auto settings = ReferenceFirmware::standard();
  settings.identity.watchdog_ms = 100;
  Rig<ReferenceFirmware> other(settings);
  UsbHand hand(std::make_unique<ref::ReferenceProtocol>(kPlace), other.settings());
  EXPECT_TRUE(eventually([&] { return other.notices.has("run for 100 ms"); }));
}

TEST_F(ReferenceDevice, EndpointsAreFoundWhereverTheControllerPutsThem) {
  auto settings = ReferenceFirmware::standard();
  settings.in_address = 0x86;
  settings.out_address = 0x07;
  Rig<ReferenceFirmware> other(settings);
  UsbHand hand(std::make_unique<ref::ReferenceProtocol>(kPlace), other.settings());
  EXPECT_TRUE(eventually([&] { return is_ready(hand); }));
}

}  // namespace
}  // namespace kerf::usb_test
