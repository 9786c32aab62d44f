// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/falcon/falcon_protocol.h"
#include "haptic_agent/device/reference/reference_protocol.h"
#include "haptic_agent/device/spacemouse/space_mouse.h"
#include "haptic_agent/device/usb/usb_haptic_device.h"
#include "haptic_agent/doctor/doctor.h"
#include "tests/support/test.h"
#include "tests/usb/mock_bus.h"
#include "tests/usb/model/falcon_model.h"
#include "tests/usb/model/reference_firmware.h"
#include "tests/usb/model/space_mouse_model.h"
#include "tests/usb/rig.h"

namespace kerf::usb_test::hotplug_test {
namespace {

using agent::DevicePhase;
using agent::UsbHapticDevice;
namespace ref = agent::reference;

constexpr std::uint64_t kOftenUs = 20'000;
/// A pause so long that a device can only be found by a hot-plug event.
constexpr std::uint64_t kRarelyUs = 3'600'000'000;

class HotPlug : public ::testing::Test {
 protected:
  std::unique_ptr<UsbHapticDevice> make_pen(std::uint64_t pause_us = kOftenUs) {
    return std::make_unique<UsbHapticDevice>(
        std::make_unique<ref::ReferenceProtocol>(ref::PenPlace{}), settings(pause_us));
  }
  agent::UsbPortSettings settings(std::uint64_t pause_us = kOftenUs) {
    return {.notice = [this](const std::string& line) { notices.add(line); },
            .first_pause_us = pause_us,
            .longest_pause_us = pause_us};
  }

  MockBus bus;
  Notices notices;
  ReferenceFirmware firmware;
};

TEST_F(HotPlug, PresentDeviceIsFoundAndHomed) {
  MockDevice device(bus, firmware, 5);
  device.plug();
  const auto pen = make_pen();
  EXPECT_TRUE(eventually([&] { return is_ready(*pen); }));
  EXPECT_TRUE(eventually([&] { return pen->read(agent::monotonic_us()).valid; }));
}

TEST_F(HotPlug, DevicePluggedInLaterIsFoundImmediately) {
  const auto pen = make_pen(kRarelyUs);
  EXPECT_TRUE(eventually([&] { return notices.has("not plugged in"); }));
  MockDevice device(bus, firmware, 5);
  device.plug();
  EXPECT_TRUE(eventually([&] { return is_ready(*pen); }));
}

TEST_F(HotPlug, ReconnectsAtAnotherAddress) {
  auto device = std::make_unique<MockDevice>(bus, firmware, 5);
  device->plug();
  const auto pen = make_pen();
  ASSERT_TRUE(eventually([&] { return is_ready(*pen); }));
  device->unplug();
  EXPECT_TRUE(
      eventually([&] { return pen->read(agent::monotonic_us()).phase == DevicePhase::kClosed; }));
  ReferenceFirmware again;
  MockDevice next(bus, again, 9);
  next.plug();
  EXPECT_TRUE(eventually([&] { return is_ready(*pen); }));
  EXPECT_EQ(pen->counters().losses.load(), 1U);
}

TEST_F(HotPlug, FreeDeviceOfTwoIsUsedInAnyOrder) {
  for (const auto& [held_at, free_at] : {std::pair{3, 4}, {4, 3}}) {
    ReferenceFirmware one, other;
    MockDevice held(bus, one, held_at), free(bus, other, free_at);
    held.reject_claims(EBUSY);
    held.plug();
    free.plug();
    const auto pen = make_pen();
    EXPECT_TRUE(eventually([&] { return is_ready(*pen); })) << free_at;
    EXPECT_TRUE(free.claimed());
    EXPECT_FALSE(held.claimed());
  }
}

TEST_F(HotPlug, SeveralDevicesStreamConcurrently) {
  FalconModel falcon;
  SpaceMouseModel cap;
  MockDevice first(bus, cap, 3), second(bus, falcon, 4), third(bus, firmware, 5);
  for (MockDevice* device : {&first, &second, &third}) device->plug();
  const auto pen = make_pen();
  agent::SpaceMouse mouse({}, settings());
  UsbHapticDevice grip(
      std::make_unique<agent::falcon::FalconProtocol>(agent::falcon::FalconSettings{}), settings());
  EXPECT_TRUE(eventually([&] { return is_ready(*pen) && is_ready(mouse) && is_ready(grip); }));
}

TEST_F(HotPlug, PermissionErrorNamesTheUdevRule) {
  MockDevice device(bus, firmware, 5);
  device.plug();
  MockBus::reject_opening(EACCES);
  const auto pen = make_pen();
  EXPECT_TRUE(eventually([&] { return notices.has("70-kerf.rules"); }));
  MockBus::reject_opening(0);
  EXPECT_TRUE(eventually([&] { return is_ready(*pen); }));
}

TEST_F(HotPlug, OtherUsbIdsAreIgnored) {
  SpaceMouseModel cap;
  MockDevice device(bus, cap, 5);
  device.plug();
  const auto pen = make_pen();
  EXPECT_TRUE(eventually([&] { return notices.has("not plugged in"); }));
  EXPECT_FALSE(device.claimed());
}

TEST_F(HotPlug, DoctorFindsAndMeasuresTheDevice) {
  MockDevice device(bus, firmware, 5);
  device.plug();
  std::ostringstream out;
  const char* words[] = {"doctor", "--device", "usb", "--seconds", "0.1"};
  agent::run_doctor(5, words, out);
  for (const char* line :
       {"ok       the 5-DOF reference device at /dev/bus/usb/001/005 is accessible",
        "ok       the 5-DOF reference device is ready",
        "the 5-DOF reference device acknowledges commands after "}) {
    EXPECT_TRUE(out.str().contains(line)) << line << "\n" << out.str();
  }
}

}  // namespace
}  // namespace kerf::usb_test::hotplug_test
