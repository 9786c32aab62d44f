// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/reference/reference_protocol.h"
#include "server/wire/types.h"
#include "tests/support/test.h"
#include "tests/usb/model/reference_firmware.h"
#include "tests/usb/rig.h"

namespace kerf::usb_test::reference_device_test {
namespace {

using agent::DevicePhase;
using agent::UsbHapticDevice;
namespace ref = agent::reference;

constexpr ref::PenPlace kPlace{.middle_mm = {10, 20, 30}, .pivot_mm = 60};

class ReferenceDevice : public ::testing::Test {
 protected:
  std::unique_ptr<UsbHapticDevice> make() {
    return std::make_unique<UsbHapticDevice>(std::make_unique<ref::ReferenceProtocol>(kPlace),
                                             rig.settings());
  }
  double greatest_torque() {
    return rig.query([](ReferenceFirmware& firmware) {
      double most = 0;
      for (const double t : firmware.motors_nmm(agent::monotonic_us())) {
        most = std::max(most, std::abs(t));
      }
      return most;
    });
  }
  /// Writes at the servo's rate until the motors satisfy a condition.
  template <typename Condition>
  bool write_until(UsbHapticDevice& device, const Wrench& wrench, Condition condition) {
    return eventually([&] {
      device.read(agent::monotonic_us());
      device.write(wrench);
      return condition();
    });
  }
  bool pulls() { return greatest_torque() > 50; }
  bool rests() { return greatest_torque() == 0; }

  Rig<ReferenceFirmware> rig;
  const Wrench push{.force_n = {3, 0, 0}, .torque_nmm = {}};
};

TEST_F(ReferenceDevice, HomesAndReportsThePose) {
  const auto device = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*device); }));
  const Vec3 axis = normalized({0.2, -0.1, 1});
  const Vec3 grip{5, -7, 52};
  rig.query([&](ReferenceFirmware& firmware) {
    firmware.hold(grip, axis);
    firmware.press(ref::kCutButton | ref::kGripSensor);
    return 0;
  });
  // At the grip's center position, the tip of an upright tool is at the center of the workspace.
  const Vec3 tip = kPlace.middle_mm + Vec3{0, 0, 60} + grip - Vec3{0, 0, 40} - axis * 60;
  agent::DeviceState state;
  EXPECT_TRUE(eventually([&] {
    state = device->read(agent::monotonic_us());
    return length(state.tip_mm - tip) < 0.01 && state.valid;
  }));
  EXPECT_LT(length(state.axis - axis), 1e-4);
  EXPECT_EQ(state.buttons, wire::kButtonCutting | wire::kButtonDeadman);
  EXPECT_TRUE(device->trouble().empty());
  rig.query([](ReferenceFirmware& firmware) {
    firmware.press(ref::kClutchButton | ref::kGripSensor);
    return 0;
  });
  EXPECT_TRUE(eventually([&] {
    return device->read(agent::monotonic_us()).buttons ==
           (agent::kButtonClutch | wire::kButtonDeadman);
  }));
}

TEST_F(ReferenceDevice, NoForceBeforeHoming) {
  auto slow = ReferenceFirmware::standard();
  slow.homing_us = 200'000;
  Rig<ReferenceFirmware> slow_rig(slow);
  UsbHapticDevice device(std::make_unique<ref::ReferenceProtocol>(kPlace), slow_rig.settings());
  ASSERT_TRUE(
      eventually([&] { return device.read(agent::monotonic_us()).phase == DevicePhase::kHoming; }));
  bool pulled_early = false;
  EXPECT_TRUE(eventually([&] {
    const auto state = device.read(agent::monotonic_us());
    device.write(push);
    slow_rig.query([&](ReferenceFirmware& firmware) {
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

TEST_F(ReferenceDevice, OutputsTheWrenchByVirtualWork) {
  const auto device = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*device); }));
  ASSERT_TRUE(write_until(*device, push, [&] { return pulls(); }));
  // Each motor's torque is the derivative of the force's work by that joint's angle.
  const auto pen = agent::standard_pen();
  const agent::PenAngles q{reach_for(pen.front, {0, 0, 0}), reach_for(pen.rear, {0, 0, 80})};
  const auto torques = rig.query(
      [](ReferenceFirmware& firmware) { return firmware.motors_nmm(agent::monotonic_us()); });
  constexpr double kTurn = 1e-6;
  for (std::size_t i = 0; i < 3; ++i) {
    auto front = q.front, rear = q.rear;
    front[i] += kTurn;
    rear[i] += kTurn;
    const double by_front = agent::arm_point(pen.front, front).x / kTurn;
    const double by_rear = agent::arm_point(pen.rear, rear).x / kTurn;
    EXPECT_NEAR(torques[i], 1.5 * by_front, 0.3);
    EXPECT_NEAR(torques[i + 3], 1.5 * by_rear, 0.3);
  }
}

TEST_F(ReferenceDevice, StopClearsTheForceWithoutTheServo) {
  const auto device = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*device); }));
  ASSERT_TRUE(write_until(*device, push, [&] { return pulls(); }));
  device->write(push);
  std::thread watchdog([&] { device->stop(); });
  watchdog.join();
  EXPECT_TRUE(eventually([&] { return rests(); }));
  EXPECT_TRUE(write_until(*device, push, [&] { return pulls(); }));
}

TEST_F(ReferenceDevice, ForceTimesOutWithoutWrites) {
  const auto device = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*device); }));
  ASSERT_TRUE(write_until(*device, push, [&] { return pulls(); }));
  EXPECT_TRUE(eventually([&] { return rests(); }));
  // The driver did this, not the firmware's watchdog: commands continued.
  EXPECT_FALSE(rig.query([](ReferenceFirmware& firmware) { return firmware.watchdog_tripped(); }));
}

TEST_F(ReferenceDevice, FirmwareWatchdogClearsTheForceOfAHangingHost) {
  const auto device = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*device); }));
  ASSERT_TRUE(write_until(*device, push, [&] { return pulls(); }));
  rig.bus.hold_out(true);
  EXPECT_TRUE(write_until(*device, push, [&] {
    return rig.query([](ReferenceFirmware& firmware) {
      firmware.motors_nmm(agent::monotonic_us());
      return firmware.watchdog_tripped();
    });
  }));
  EXPECT_TRUE(rests());
  rig.bus.hold_out(false);
  EXPECT_TRUE(write_until(*device, push, [&] { return pulls(); }));
}

TEST_F(ReferenceDevice, ClosingClearsTheForce) {
  auto device = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*device); }));
  ASSERT_TRUE(write_until(*device, push, [&] { return pulls(); }));
  device.reset();
  EXPECT_TRUE(eventually([&] { return rests(); }));
  // The driver's last command did this, not the firmware's watchdog.
  EXPECT_FALSE(rig.query([](ReferenceFirmware& firmware) { return firmware.watchdog_tripped(); }));
}

TEST_F(ReferenceDevice, NonFiniteWrenchBecomesZero) {
  const auto device = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*device); }));
  ASSERT_TRUE(write_until(*device, push, [&] { return pulls(); }));
  const Wrench broken{.force_n = {std::nan(""), 0, 0}, .torque_nmm = {}};
  EXPECT_TRUE(write_until(*device, broken, [&] { return rests(); }));
}

TEST_F(ReferenceDevice, DeviceFaultPreventsReady) {
  const auto device = make();
  ASSERT_TRUE(eventually([&] { return is_ready(*device); }));
  struct Fault {
    decltype(ref::kTooHotBit) bit;
    const char* words;
  };
  for (const Fault& fault :
       {Fault{ref::kEmergencyStopBit, "emergency stop"}, Fault{ref::kTooHotBit, "too hot"},
        Fault{ref::kOverCurrentBit, "too much current"}}) {
    rig.query([&](ReferenceFirmware& firmware) { return firmware.fail(fault.bit), 0; });
    EXPECT_TRUE(eventually([&] { return !is_ready(*device); })) << fault.words;
    EXPECT_TRUE(eventually([&] {
      return device->trouble().find(fault.words) != std::string::npos;
    })) << fault.words;
    rig.query([](ReferenceFirmware& firmware) { return firmware.fail(0), 0; });
    EXPECT_TRUE(eventually([&] { return is_ready(*device); })) << fault.words;
  }
}

TEST_F(ReferenceDevice, OtherVersionIsRejected) {
  auto settings = ReferenceFirmware::standard();
  settings.identity.version = 2;
  Rig<ReferenceFirmware> other(settings);
  UsbHapticDevice device(std::make_unique<ref::ReferenceProtocol>(kPlace), other.settings());
  EXPECT_TRUE(eventually([&] { return other.notices.has("version 2 of the protocol"); }));
  EXPECT_EQ(device.read(agent::monotonic_us()).phase, DevicePhase::kClosed);
}

TEST_F(ReferenceDevice, SlowWatchdogIsRejected) {
  auto settings = ReferenceFirmware::standard();
  settings.identity.watchdog_ms = 100;
  Rig<ReferenceFirmware> other(settings);
  UsbHapticDevice device(std::make_unique<ref::ReferenceProtocol>(kPlace), other.settings());
  EXPECT_TRUE(eventually([&] { return other.notices.has("timeout is 100 ms"); }));
}

TEST_F(ReferenceDevice, AnyEndpointAddressesAreFound) {
  auto settings = ReferenceFirmware::standard();
  settings.in_address = 0x86;
  settings.out_address = 0x07;
  Rig<ReferenceFirmware> other(settings);
  UsbHapticDevice device(std::make_unique<ref::ReferenceProtocol>(kPlace), other.settings());
  EXPECT_TRUE(eventually([&] { return is_ready(device); }));
}

}  // namespace
}  // namespace kerf::usb_test::reference_device_test
