// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/device_choice.h"

#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::agent::device_choice_test {
namespace {

TEST(DeviceChoice, SimWithoutFileUsesTheCarvingFigure) {
  const auto choice = test::value_of(choose_device("sim"));
  EXPECT_FALSE(choice.script);
  const auto device = test::value_of(make_device(choice, {.stock = {{0, 0, 0}, {10, 10, 10}}}, {}));
  EXPECT_EQ(device->capabilities().actuated_dof, 5);
}

TEST(DeviceChoice, FileIsPlayedBySimOrReplay) {
  const test::TemporaryFolder folder;
  const auto path = folder / "hand.apt";
  std::ofstream(path) << "FEDRAT/60\nGOTO/0,0,0\nGOTO/1,0,0\n";
  const auto hand = choose_device("sim:" + path.string());
  const auto replay = choose_device("replay:" + path.string());
  ASSERT_TRUE(hand && replay);
  EXPECT_EQ(make_device(*hand, {}, {}).value()->capabilities().actuated_dof, 5);
  EXPECT_EQ(make_device(*replay, {}, {}).value()->capabilities().actuated_dof, 0);
}

TEST(DeviceChoice, UsbDevicesAreChosenByName) {
  EXPECT_EQ(choose_device("usb")->kind, DeviceKind::kReference);
  EXPECT_EQ(choose_device("falcon")->kind, DeviceKind::kFalcon);
  EXPECT_EQ(choose_device("spacemouse")->kind, DeviceKind::kSpaceMouse);
  EXPECT_EQ(choose_device("usb:16c0:0486")->usb_id, (UsbId{0x16c0, 0x0486}));
}

TEST(DeviceChoice, MissingUsbDeviceIsClosed) {
  for (const char* name : {"usb", "falcon", "spacemouse"}) {
    const auto device = make_device(*choose_device(name), {}, {}).value();
    const DeviceState state = device->read(1000);
    EXPECT_FALSE(state.valid) << name;
    EXPECT_EQ(state.phase, DevicePhase::kClosed) << name;
  }
}

TEST(DeviceChoice, InvalidTextIsRejected) {
  for (const char* name :
       {"", "joystick", "replay", "replay:", "sim:/no/such.apt", "sim:x.ngc", "usb:", "usb:1209",
        "usb:1209:", "usb:zz:1", "usb:11209:1", "falcon:/no/such", "spacemouse:1"}) {
    EXPECT_FALSE(choose_device(name)) << name;
  }
}

}  // namespace
}  // namespace kerf::agent::device_choice_test
