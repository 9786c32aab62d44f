// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/mapping_options.h"

#include <nlohmann/json.hpp>

#include "haptic_agent/options.h"
#include "haptic_agent/summary.h"
#include "tests/support/test.h"

namespace kerf::agent::mapping_options_test {
namespace {

const DeviceCapabilities kDevice{
    .name = "test device", .workspace_min_mm = {-60, -60, -40}, .workspace_max_mm = {60, 60, 40}};
const StockBox kTooth{{-1.5, -1.5, -1.5}, {1.5, 1.5, 0}};

std::string line_of(const MappingTexts& texts, const DeviceCapabilities& device,
                    const StockBox& stock) {
  const MappingOptions options = read_mapping(texts).value();
  return mapping_notice(options, mapping_of(options, device, stock)->at_start, device, stock);
}

TEST(MappingOptions, CommandLineIsParsedAndErrorsNameTheOption) {
  const MappingOptions options =
      *read_mapping({.scale = "0.025", .gain = 4, .turn_deg = "90", .clutch = "undo"});
  EXPECT_EQ(options.choice.scale, 0.025);
  EXPECT_FALSE(options.choice.fits);
  EXPECT_EQ(options.choice.gain, 4);
  EXPECT_NEAR(options.choice.turn_rad.z, std::numbers::pi / 2, 1e-12);
  EXPECT_EQ(options.clutch, ClutchButton::kUndo);
  EXPECT_TRUE(read_mapping({.scale = "auto"})->choice.fits);
  EXPECT_NEAR(read_mapping({.turn_deg = "90,0,-45"})->choice.turn_rad.x, std::numbers::pi / 2,
              1e-12);
  for (const char* scale : {"0", "-1", "1e4", "big", "", "nan"}) {
    EXPECT_EQ(read_mapping({.scale = scale}).error(),
              "--scale: must be auto or a number from 0.001 to 1000");
  }
  EXPECT_TRUE(read_mapping({.turn_deg = "-360"}));
  EXPECT_TRUE(read_mapping({.turn_deg = "0,-360,0"}));
  EXPECT_LE(length(read_mapping({.turn_deg = "200,200,-220"})->choice.turn_rad),
            2 * std::numbers::pi);
  for (const char* turn :
       {"", "1,2", "1,2,3,4", "x", "400", "-361", "nan", "300,300,0", "0,0,361"}) {
    EXPECT_TRUE(read_mapping({.turn_deg = turn}).error().starts_with("--turn: must be degrees"));
  }
  EXPECT_EQ(read_mapping({.clutch = "foot"}).error(),
            "--clutch: must be own, deadman, undo or redo");
  const char* words[] = {"kerf-agent", "--session", "demo", "--device", "sim", "--scale",
                         "auto",       "--gain",    "2",    "--turn",   "30"};
  const auto read = test::value_of(read_options(std::size(words), words));
  EXPECT_TRUE(read.mapping.choice.fits);
  EXPECT_EQ(read.mapping.choice.gain, 2);
}

TEST(MappingOptions, MiddleOfTheWorkspaceStaysUnlessTheStockIsFitted) {
  const StockBox stock{{0, 0, -50}, {100, 100, 0}};
  const auto mapping = [&](const char* scale, const DeviceCapabilities& device) {
    return mapping_of(*read_mapping({.scale = scale}), device, stock)->at_start;
  };
  DeviceCapabilities placed = kDevice;
  placed.workspace_min_mm = {-10, -10, -40};
  placed.workspace_max_mm = {110, 110, 40};
  const WorkspaceMapping fixed = mapping("0.5", placed);
  EXPECT_EQ(fixed.device_mm, (Vec3{50, 50, 0}));
  EXPECT_EQ(fixed.block_mm, fixed.device_mm);
  EXPECT_TRUE(SpaceMap(mapping("1", placed)).is_identity());
  const WorkspaceMapping fit = mapping("auto", placed);
  EXPECT_NEAR(fit.scale, 100 / (0.8 * 120), 1e-12);
  EXPECT_EQ(fit.block_mm, (Vec3{50, 50, -25}));
  const WorkspaceMapping unknown = mapping("auto", {.name = "unknown"});
  EXPECT_TRUE(SpaceMap(unknown).is_identity());
  EXPECT_EQ(mapping("3", {}).block_mm, (Vec3{50, 50, 0})) << "the middle of the stock's top";
}

TEST(MappingOptions, OneLineStatesScaleForceAndStiffness) {
  EXPECT_EQ(
      line_of({.scale = "0.04"}, kDevice, kTooth),
      "scale 0.04 (device 120 mm → block 4.8 mm), force gain 1, stiffness at the hand 0.04 x");
  EXPECT_EQ(line_of({.scale = "8", .gain = 0.5, .turn_deg = "-90"}, {.name = "unknown"}, kTooth),
            "scale 8 (device 1 mm → block 8 mm), turned by 90 degrees, force gain 0.5, stiffness "
            "at the hand 4 x");
  EXPECT_EQ(line_of({}, {.name = "unknown"}, kTooth), "") << "nothing is known or asked for";
  EXPECT_EQ(line_of({}, kDevice, {{-100, -10, -30}, {100, 10, 0}}),
            "scale 1 (device 120 mm → block 120 mm), force gain 1, stiffness at the hand 1 x; the "
            "device does not reach all of the stock: --scale auto fits it");
  EXPECT_EQ(line_of({.scale = "auto"}, {.name = "unknown"}, kTooth),
            "scale 1 (device 1 mm → block 1 mm), force gain 1, stiffness at the hand 1 x; the "
            "device does not state its workspace, so --scale auto uses 1; --scale S sets another");
  EXPECT_EQ(line_of({.scale = "50"}, kDevice, kTooth),
            "scale 50 (device 120 mm → block 6000 mm), force gain 1, stiffness at the hand 50 x; "
            "the server takes no cuts faster than 100 mm/s of the hand");
}

TEST(MappingOptions, DeadmanIsAClutchOnlyIfTheDeviceSensesIt) {
  const MappingOptions options = *read_mapping({.clutch = "deadman"});
  EXPECT_EQ(mapping_of(options, kDevice, kTooth).error(),
            "--clutch deadman: the test device does not sense that it is held; use own, undo or "
            "redo");
  DeviceCapabilities held = kDevice;
  held.has_deadman = true;
  EXPECT_EQ(mapping_of(options, held, kTooth)->clutch, ClutchButton::kDeadman);
}

TEST(Summary, ContainsTheMappingAsJson) {
  Summary summary;
  summary.mapping = {.scale = 0.5, .gain = 3, .turn_rad = {0, 0, 1}};
  const auto json = nlohmann::json::parse(summary_json(summary))["mapping"];
  EXPECT_EQ(json, nlohmann::json::parse(
                      R"({"scale":0.5,"force_gain":3.0,"stiffness_scale":1.5,
                          "turn_rad":[0.0,0.0,1.0]})"));
}

}  // namespace
}  // namespace kerf::agent::mapping_options_test
