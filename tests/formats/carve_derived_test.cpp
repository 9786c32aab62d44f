// SPDX-License-Identifier: Apache-2.0
// kerf-carve without a scene, and with parts of one on the command line.
#include "tests/formats/carve_fixture.h"

namespace kerf::carve_derived_test {
namespace {

using test::KerfCarve;
using testing::HasSubstr;
using testing::Not;

const std::string kInput = "--scene scene.json --program p.ngc";

TEST_F(KerfCarve, AssumedBorderMakesNoThinWall) {
  write(
      "c.ngc",
      "G21 G90\nT1 M6 (D=6 flat end mill)\nG0 X-20 Y0 Z5\nG1 Z-4 F300\nG2 I20 F600\nG0 Z20\nM2\n");
  EXPECT_EQ(run("c.ngc"), 0) << content("err");
  EXPECT_THAT(content("err"), Not(HasSubstr("at the border of the stock")));
  EXPECT_THAT(content("err"), Not(HasSubstr("is not met")));
  EXPECT_EQ(run("c.ngc --stock 46,46,6"), 0) << content("err");
  EXPECT_THAT(content("err"), HasSubstr("at the border of the stock")) << "of a stated stock";
}

TEST_F(KerfCarve, ReportsTheProvenanceOfADerivedScene) {
  write("c.ngc", "G21 G90\n(T1 6MM DRILL)\nT1 M6\nG0 X5 Y5 Z5\nG1 Z-4 F300\nG0 Z20\nM2\n");
  const auto json = report("c.ngc");
  bool found = false;
  for (const auto& field : json["provenance"])
    if (field["tool"] == 1 && field["field"] == "diameter_mm")
      found = field["origin"] == "stated" && field["source"] == "comment in line 2";
  EXPECT_TRUE(found) << json["provenance"];
  EXPECT_TRUE(report(kInput)["provenance"].empty());
}

TEST_F(KerfCarve, ToolInsideTheStockRevealsTheRotaryDirection) {
  write("b.nc",
        "G21 G90\nT1 M6\nG0 X60 Y0 Z30\nG43.4 H1 B60.\nG0 X25. Z-10.\nG1 X18. F100\nX25.\nM30\n");
  const auto scene = [&](const std::string& direction) {
    write("b.json",
          R"({"name": "b", "stock": {"shape": "box", "min_mm": [-20,-20,-40], "max_mm": [20,20,0]},
              "accuracy": {"pitch_mm": 1},
              "tools": [{"id": 1, "shape": "flat", "diameter_mm": 6, "length_mm": 60}],
              "machine": {"kinematics": "xyzbc-trt", "rotary_direction": ")" +
              direction + "\"}}");
    EXPECT_EQ(run("--scene b.json --program b.nc --dialect fanuc --wall-samples 0"), 0)
        << content("err");
    return content("err");
  };
  EXPECT_THAT(scene("table"), HasSubstr("a positive angle may turn the tool and not the table"));
  EXPECT_THAT(scene("tool"), Not(HasSubstr("a positive angle may turn")));
}

TEST_F(KerfCarve, OffersTheMechanisticLawOfAMaterial) {
  const auto json = report(kInput + " --law mechanistic --material beech");
  EXPECT_GT(json["simulation"]["max_force"]["n"], 0);
  EXPECT_EQ(run(kInput + " --law mechanistic"), 2);
  EXPECT_THAT(content("err"), HasSubstr("--material"));
  EXPECT_EQ(run(kInput + " --material beech"), 2);
  EXPECT_EQ(run(kInput + " --law mechanistic --material cheese"), 2);
}

TEST_F(KerfCarve, AsksForTheDirectionOfRotaryAxes) {
  write(
      "b.nc",
      "G21 G90\nT1 M6 (D=6 flat end mill)\nG0 X0 Y0 Z20 B30.\nG43.4 H1\nG1 X0 Z-2 F99\nX5\nM30\n");
  EXPECT_EQ(run("b.nc --dialect fanuc --write-scene a.json"), 0) << content("err");
  EXPECT_THAT(content("err"), HasSubstr("--rotary tool states"));
  EXPECT_EQ(run("b.nc --dialect fanuc --rotary tool --write-scene b.json"), 0) << content("err");
  EXPECT_EQ(nlohmann::json::parse(content("b.json"))["machine"]["rotary_direction"], "tool");
  EXPECT_FALSE(nlohmann::json::parse(content("a.json"))["machine"].contains("rotary_direction"));
}

}  // namespace
}  // namespace kerf::carve_derived_test
