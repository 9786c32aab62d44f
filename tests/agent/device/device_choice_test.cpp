#include "haptic_agent/device/device_choice.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace kerf::agent {
namespace {

TEST(DeviceChoice, SimAloneBringsItsOwnFigure) {
  const auto choice = choose_device("sim");
  ASSERT_TRUE(choice);
  EXPECT_FALSE(choice->script);
  const auto device = make_device(*choice, {.stock = {{0, 0, 0}, {10, 10, 10}}}, {});
  EXPECT_EQ(device->capabilities().actuated_dof, 5);
}

TEST(DeviceChoice, AFileMakesAHandOrAReplay) {
  const auto path = std::filesystem::temp_directory_path() / "kerf_agent_choice.apt";
  std::ofstream(path) << "FEDRAT/60\nGOTO/0,0,0\nGOTO/1,0,0\n";
  const auto hand = choose_device("sim:" + path.string());
  const auto replay = choose_device("replay:" + path.string());
  ASSERT_TRUE(hand && replay);
  EXPECT_EQ(make_device(*hand, {}, {})->capabilities().actuated_dof, 5);
  EXPECT_EQ(make_device(*replay, {}, {})->capabilities().actuated_dof, 0);
  std::filesystem::remove(path);
}

TEST(DeviceChoice, SaysWhichDevicesAreNotThere) {
  for (const char* name : {"usb", "falcon", "spacemouse"}) {
    const auto choice = choose_device(name);
    ASSERT_FALSE(choice);
    EXPECT_NE(choice.error().find("not available yet"), std::string::npos);
  }
  for (const char* name : {"", "joystick", "replay", "replay:", "sim:/no/such.apt", "sim:x.ngc"}) {
    EXPECT_FALSE(choose_device(name)) << name;
  }
}

}  // namespace
}  // namespace kerf::agent
