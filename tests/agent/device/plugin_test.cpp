// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/device_choice.h"
#include "haptic_agent/device/plugin/c_structs.h"
#include "haptic_agent/device/plugin/plugin_device.h"
#include "server/wire/types.h"
#include "tests/agent/device/fake_plugin.h"
#include "tests/support/test.h"

namespace kerf::agent::plugin_test {
namespace {

constexpr StockBox kStock{{0, 0, -20}, {40, 30, 0}};

std::string file_of(const char* name) { return std::string(KERF_PLUGIN_DIR "/") + name + ".so"; }

class PluginTest : public ::testing::Test {
 protected:
  PluginTest() {
    log.capabilities.struct_size = sizeof log.capabilities;
    log.capabilities.sensed_dof = 3;
    log.capabilities.actuated_dof = 3;
    log.capabilities.max_force_n = 10;
    log.capabilities.latency_us = 2000;
    log.pose.struct_size = sizeof log.pose;
  }
  std::string text() const {
    return file_of("fake_plugin") + ":" + std::to_string(reinterpret_cast<std::uintptr_t>(&log));
  }
  auto open() const {
    const auto plugin = load_plugin(text());
    EXPECT_TRUE(plugin) << (plugin ? "" : plugin.error().text);
    return PluginDevice::open(*plugin, kStock, 60, 7);
  }
  PluginFault open_fault() const {
    const auto device = open();
    EXPECT_FALSE(device);
    return device ? PluginFault::kNotLoaded : device.error().fault;
  }

  FakePluginLog log;
};

PluginError error_of(const std::string& text) {
  const auto plugin = load_plugin(text);
  EXPECT_FALSE(plugin) << text;
  return plugin ? PluginError{} : plugin.error();
}

TEST_F(PluginTest, DeviceGetsTheSessionAndExchangesPosesAndWrenches) {
  {
    const auto opened = test::value_of(open());
    PluginDevice& device = *opened;
    EXPECT_EQ(log.place.participant, 7U);
    EXPECT_EQ(log.place.stock_max_mm[0], 40);
    EXPECT_EQ(log.place.pivot_mm, 60);
    const DeviceCapabilities capabilities = device.capabilities();
    EXPECT_EQ(capabilities.name, "fake plugin");
    EXPECT_EQ(capabilities.max_force_n, 10);
    EXPECT_EQ(capabilities.latency_us, 2000U);
    EXPECT_FALSE(capabilities.has_deadman);

    EXPECT_FALSE(device.read(5000).valid);
    EXPECT_EQ(device.read(5000).phase, DevicePhase::kClosed);
    EXPECT_EQ(device.trouble(), "the fake plugin is not connected");
    log.pose.state = KERF_AGENT_READY;
    log.pose.tip_mm[1] = 3;
    log.pose.axis[2] = 1;
    log.pose.buttons = KERF_AGENT_CUT;
    const DeviceState state = device.read(6000);
    EXPECT_EQ(log.asked_us, 6000U);
    EXPECT_TRUE(state.valid);
    EXPECT_EQ(state.tip_mm.y, 3);
    EXPECT_EQ(state.time_us, 6000U);
    EXPECT_EQ(state.buttons, wire::kButtonCutting | wire::kButtonDeadman) << "always held";
    EXPECT_EQ(device.trouble(), "");

    device.write({.force_n = {1, 2, 3}, .torque_nmm = {4, 5, 6}});
    EXPECT_EQ(log.wrench.force_n[2], 3);
    EXPECT_EQ(log.wrench.torque_nmm[0], 0) << "no torque is rated";
    device.stop();
    EXPECT_EQ(log.stops, 1);
  }
  EXPECT_EQ(log.stops, 2) << "motors off before it is closed";
  EXPECT_EQ(log.closes, 1);
}

TEST_F(PluginTest, MotorsGetOnlyRatedComponents) {
  log.capabilities.actuated_dof = 5;
  log.capabilities.max_torque_nmm = 100;
  const Wrench wrench{.force_n = {1, 2, 3}, .torque_nmm = {4, 5, 6}};
  {
    const auto opened = test::value_of(open());
    opened->write(wrench);
    EXPECT_EQ(log.wrench.force_n[2], 3);
    EXPECT_EQ(log.wrench.torque_nmm[0], 4);
  }
  log.capabilities.actuated_dof = 0;
  log.capabilities.max_force_n = 0;
  const auto sensor = test::value_of(open());
  sensor->write(wrench);
  EXPECT_EQ(log.wrench.force_n[2], 0);
  EXPECT_EQ(log.wrench.torque_nmm[0], 0);
}

TEST_F(PluginTest, MissingStopIsReplacedByAZeroWrench) {
  auto plugin = test::value_of(load_plugin(text()));
  plugin.functions.stop = nullptr;
  const auto opened = test::value_of(PluginDevice::open(plugin, kStock, 60, 7));
  opened->write({.force_n = {1, 2, 3}});
  EXPECT_EQ(log.wrench.force_n[2], 3);
  opened->stop();
  EXPECT_EQ(log.wrench.force_n[2], 0);
}

TEST_F(PluginTest, PosesOutOfTimeOrInOtherStatesAreInvalid) {
  const auto opened = test::value_of(open());
  log.pose.state = KERF_AGENT_READY;
  log.pose.time_us = 100'000;
  EXPECT_TRUE(opened->read(119'999).valid);
  EXPECT_FALSE(opened->read(120'000).valid);
  EXPECT_TRUE(opened->read(80'000).valid);
  EXPECT_FALSE(opened->read(79'999).valid) << "in the future";
  log.pose.time_us = UINT64_MAX;
  EXPECT_FALSE(opened->read(100'000).valid);
  log.pose.time_us = 0;
  for (const std::uint32_t state : {KERF_AGENT_FAULT, KERF_AGENT_HOMING, KERF_AGENT_ABSENT}) {
    log.pose.state = state;
    EXPECT_FALSE(opened->read(1000).valid) << state;
    EXPECT_NE(opened->trouble(), "") << state;
  }
  log.pose.state = KERF_AGENT_FINISHED;
  EXPECT_TRUE(opened->read(1000).finished);
}

TEST_F(PluginTest, DeadmanSensorIsReported) {
  log.capabilities.flags = KERF_AGENT_HAS_DEADMAN;
  const auto opened = test::value_of(open());
  log.pose.state = KERF_AGENT_READY;
  EXPECT_EQ(opened->read(1000).buttons & wire::kButtonDeadman, 0U);
  log.pose.buttons = KERF_AGENT_DEADMAN;
  EXPECT_NE(opened->read(1000).buttons & wire::kButtonDeadman, 0U);
}

TEST_F(PluginTest, EachFaultHasATypeAndASentence) {
  EXPECT_EQ(error_of("").fault, PluginFault::kNotLoaded);
  const PluginError missing = error_of("/no/such/driver.so");
  EXPECT_EQ(missing.fault, PluginFault::kNotLoaded);
  EXPECT_NE(missing.text.find("/no/such/driver.so"), std::string::npos) << missing.text;
  EXPECT_EQ(error_of(file_of("fake_plugin_symbol")).fault, PluginFault::kNoSymbol);
  const PluginError version = error_of(file_of("fake_plugin_abi"));
  EXPECT_EQ(version.fault, PluginFault::kVersion);
  EXPECT_NE(version.text.find("ABI 99"), std::string::npos) << version.text;
  EXPECT_EQ(error_of(file_of("fake_plugin_incomplete")).fault, PluginFault::kIncomplete);

  const auto error =
      test::error_of(PluginDevice::open(*load_plugin(file_of("fake_plugin")), kStock, 60, 1));
  EXPECT_EQ(error.fault, PluginFault::kOpen);
  EXPECT_NE(error.text.find("no argument"), std::string::npos);

  log.capabilities.latency_us = 30'000;
  EXPECT_EQ(open_fault(), PluginFault::kCapability);
  EXPECT_EQ(log.closes, 1) << "a rejected device is closed";
  log.capabilities.latency_us = 0;
  log.capabilities.workspace_min_mm[0] = 1;
  EXPECT_EQ(open_fault(), PluginFault::kCapability);
  log.capabilities.workspace_min_mm[0] = 0;
  log.capabilities.actuated_dof = 0;
  EXPECT_EQ(open_fault(), PluginFault::kCapability) << "a force without motors";
  log.capabilities.actuated_dof = 3;
  log.capabilities.max_force_n = 0;
  EXPECT_EQ(open_fault(), PluginFault::kCapability) << "motors without a force";
  log.capabilities.max_force_n = 10;
  log.rated = KERF_AGENT_DEVICE;
  EXPECT_EQ(open_fault(), PluginFault::kOpen);
}

TEST_F(PluginTest, IsChosenOnTheCommandLine) {
  const auto choice = test::value_of(choose_device("plugin:" + text()));
  EXPECT_EQ(choice.kind, DeviceKind::kPlugin);
  const auto device = test::value_of(make_device(choice, {.stock = kStock}, {}));
  EXPECT_EQ(device->capabilities().name, "fake plugin");
  EXPECT_FALSE(choose_device("plugin:/no/such.so"));
  EXPECT_FALSE(choose_device("plugin"));
  EXPECT_FALSE(make_device(*choose_device("plugin:" + file_of("fake_plugin")), {}, {}));
}

}  // namespace
}  // namespace kerf::agent::plugin_test
