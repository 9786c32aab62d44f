// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/spacemouse/space_mouse.h"

#include "server/wire/types.h"
#include "tests/support/test.h"
#include "tests/usb/model/space_mouse_model.h"
#include "tests/usb/rig.h"

namespace kerf::usb_test::space_mouse_test {
namespace {

using agent::CapDeflection;
using agent::RateControl;
using agent::SpaceMouse;

constexpr agent::StockBox kStock{.min_mm = {0, 0, 0}, .max_mm = {100, 80, 40}};

TEST(SpaceReport, BothFormatsAreDecoded) {
  CapDeflection cap;
  // 350, -350, 175 counts: right, away from the user, down by half.
  EXPECT_TRUE(agent::take_space_report(Bytes{1, 0x5E, 0x01, 0xA2, 0xFE, 0xAF, 0x00}, cap));
  EXPECT_EQ(cap.push, (Vec3{1, 1, -0.5}));
  EXPECT_EQ(cap.turn, Vec3{});
  EXPECT_TRUE(agent::take_space_report(Bytes{2, 0, 0, 0x5E, 0x01, 0, 0}, cap));
  EXPECT_EQ(cap.turn, (Vec3{0, -1, 0}));
  EXPECT_TRUE(agent::take_space_report(Bytes{1, 0, 0, 0, 0, 0, 0, 0xAF, 0, 0, 0, 0x5E, 0x01}, cap));
  EXPECT_EQ(cap.push, (Vec3{0, 0, 0}));
  EXPECT_EQ(cap.turn, (Vec3{0.5, 0, -1}));
  EXPECT_TRUE(agent::take_space_report(Bytes{3, 2, 0}, cap));
  EXPECT_EQ(cap.buttons, 2U);
}

TEST(SpaceReport, InvalidReportChangesNothing) {
  CapDeflection cap{.push = {0.1, 0, 0}};
  const CapDeflection before = cap;
  for (const Bytes& report :
       {Bytes{}, Bytes{1}, Bytes{1, 2, 3, 4, 5, 6}, Bytes{2, 0, 0}, Bytes{23, 1, 2, 3, 4, 5, 6}}) {
    EXPECT_FALSE(agent::take_space_report(report, cap));
    EXPECT_EQ(cap, before);
  }
  EXPECT_TRUE(agent::take_space_report(Bytes{1, 0xFF, 0x7F, 0, 0x80, 0, 0}, cap));
  EXPECT_EQ(cap.push, (Vec3{1, 1, 0}));
}

TEST(SpaceReport, DeadZoneIsContinuous) {
  EXPECT_EQ(agent::without_dead_zone(0.05), 0.0);
  EXPECT_EQ(agent::without_dead_zone(-0.08), 0.0);
  EXPECT_NEAR(agent::without_dead_zone(0.0801), 0.0001, 1e-3);
  EXPECT_EQ(agent::without_dead_zone(1.0), 1.0);
  EXPECT_EQ(agent::without_dead_zone(-1.0), -1.0);
}

TEST(SpaceRate, FullDeflectionIsFullSpeedWithinTheWorkspace) {
  RateControl control(kStock);
  EXPECT_EQ(control.tip_mm(), (Vec3{50, 40, 50}));
  for (int i = 0; i < 1000; ++i) control.step({.push = {0, 0, -1}}, 0.001);
  EXPECT_NEAR(control.tip_mm().z, 50 - RateControl::kFullMmPerS, 1e-9);
  for (int i = 0; i < 10'000; ++i) control.step({.push = {1, 0, -1}}, 0.001);
  EXPECT_EQ(control.tip_mm(), (Vec3{150, 40, -50}));
  RateControl slow(kStock);
  for (int i = 0; i < 1000; ++i) slow.step({.push = {1, 0, 0}, .buttons = 2}, 0.001);
  EXPECT_NEAR(slow.tip_mm().x, 50 + RateControl::kFullMmPerS * RateControl::kPrecise, 1e-9);
}

TEST(SpaceRate, TiltIsLimitedAndAxisStaysUnit) {
  RateControl control(kStock);
  for (int i = 0; i < 500; ++i) control.step({.turn = {1, 0, 1}}, 0.001);
  EXPECT_NEAR(std::acos(control.axis().z), 0.5, 0.03);
  for (int i = 0; i < 9000; ++i) control.step({.turn = {1, 0.3, 0}}, 0.001);
  EXPECT_LE(std::acos(control.axis().z), RateControl::kMaxLeanRad + 1e-9);
  EXPECT_NEAR(length(control.axis()), 1, 1e-12);
}

class SpaceMouseTest : public ::testing::TestWithParam<bool> {
 protected:
  Rig<SpaceMouseModel> rig{GetParam()};
  SpaceMouse mouse{kStock, rig.settings()};

  agent::DeviceState read() { return mouse.read(agent::monotonic_us()); }
  void push(const std::array<std::int16_t, 6>& counts) {
    rig.query([&](SpaceMouseModel& model) { return model.push(counts), 0; });
  }
};

TEST_P(SpaceMouseTest, MovesOnlyWhileTheCapIsDeflected) {
  ASSERT_TRUE(eventually([&] { return is_ready(mouse); }));
  push({350, 0, 0, 0, 0, 0});
  EXPECT_TRUE(eventually([&] { return read().tip_mm.x > 52; }));
  push({});
  EXPECT_TRUE(eventually([&] {
    const double before = read().tip_mm.x;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return read().tip_mm.x == before;
  }));
}

TEST_P(SpaceMouseTest, SilenceOf50MsStopsTheTool) {
  ASSERT_TRUE(eventually([&] { return is_ready(mouse); }));
  push({0, 0, 350, 0, 0, 0});
  EXPECT_TRUE(eventually([&] { return read().tip_mm.z < 49; }));
  rig.query([](SpaceMouseModel& model) { return model.fall_silent(), 0; });
  EXPECT_TRUE(eventually([&] {
    const double before = read().tip_mm.z;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return read().tip_mm.z == before;
  }));
  EXPECT_GT(read().tip_mm.z, mouse.capabilities().workspace_min_mm.z)
      << "it did not stop at the workspace limit";
}

TEST_P(SpaceMouseTest, PauseOfTheServoDoesNotCauseAJump) {
  ASSERT_TRUE(eventually([&] { return is_ready(mouse); }));
  push({350, 0, 0, 0, 0, 0});
  EXPECT_TRUE(eventually([&] { return read().tip_mm.x > 51; }));
  for (int i = 0; i < 5; ++i) {
    const double before = read().tip_mm.x;
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    EXPECT_LE(read().tip_mm.x - before, 0.601) << "the travel of ten milliseconds";
  }
}

TEST_P(SpaceMouseTest, CutsWhileTheLeftButtonIsPressed) {
  ASSERT_TRUE(eventually([&] { return is_ready(mouse); }));
  rig.query([](SpaceMouseModel& model) { return model.press(1), 0; });
  EXPECT_TRUE(eventually([&] { return (read().buttons & wire::kButtonCutting) != 0; }));
  rig.query([](SpaceMouseModel& model) { return model.press(0), 0; });
  EXPECT_TRUE(eventually([&] { return (read().buttons & wire::kButtonCutting) == 0; }));
  rig.query([](SpaceMouseModel& model) { return model.press(1), 0; });
  EXPECT_TRUE(eventually([&] { return (read().buttons & wire::kButtonCutting) != 0; }));
  rig.bus.unplug();
  EXPECT_TRUE(eventually([&] { return (read().buttons & wire::kButtonCutting) == 0; }));
  EXPECT_FALSE(read().valid);
}

INSTANTIATE_TEST_SUITE_P(BothFormats, SpaceMouseTest, ::testing::Bool());

}  // namespace
}  // namespace kerf::usb_test::space_mouse_test
