// SPDX-License-Identifier: Apache-2.0
// kerf-carve warns of walls and grooves thinner than the pitch, and refines the pitch for a target.
#include "tests/formats/carve_fixture.h"

namespace kerf::carve_walls_test {
namespace {

using test::KerfCarve;
using testing::HasSubstr;
using testing::StartsWith;

// Two slots with a rib of 0.14 mm between them, which no column of 0.3 mm hits.
const char* const kRibProgram =
    "G21 G90 T1 M6\nF600\nG0 X-5 Y10.43 Z6\nG1 X25\nG0 Z20\nX-5 Y13.57\nZ6\nG1 X25\nM2\n";
std::string rib_scene(const std::string& accuracy) {
  return R"({"stock": {"shape": "box", "min_mm": [0,0,0], "max_mm": [20,20,10]}, "accuracy": )" +
         accuracy + R"(, "tools": [{"id": 1, "shape": "flat", "diameter_mm": 3, "length_mm": 20}],
         "machine": {"kinematics": "xyz"}})";
}

TEST_F(KerfCarve, WarnsOfAWallThinnerThanThePitch) {
  write("rib.ngc", kRibProgram);
  write("s.json", rib_scene(R"({"pitch_mm": 0.3})"));
  const auto json = report("--scene s.json --program rib.ngc");
  ASSERT_EQ(json["warnings"].size(), 1u) << json["warnings"];
  EXPECT_THAT(std::string(json["warnings"][0]), StartsWith("rib.ngc:4: a wall of 0.14 mm at X"));
  EXPECT_THAT(std::string(json["warnings"][0]),
              testing::AllOf(HasSubstr("in line 8"), HasSubstr("is missing")));
  const auto& walls = json["thin_walls"];
  EXPECT_EQ(walls["missing"], 1);
  EXPECT_EQ(walls["walls"][0]["place"], "rib.ngc:4");
  EXPECT_NEAR(walls["walls"][0]["thickness_mm"], 0.14, 1e-4);
  EXPECT_NEAR(walls["walls"][0]["at_mm"][1], 12, 1e-4);
  EXPECT_EQ(report("--scene s.json --program rib.ngc --pitch 0.1")["thin_walls"]["count"], 0);
  EXPECT_EQ(report("--scene s.json --program rib.ngc --wall-samples 0")["thin_walls"], nullptr);
}

TEST_F(KerfCarve, TargetRefinesThePitchAtAThinWall) {
  write("rib.ngc", kRibProgram);
  write("s.json", rib_scene(R"({"target_mm": 0.3})"));
  const auto json = report("--scene s.json --program rib.ngc");
  EXPECT_LE(json["pitch_mm"], 0.142);
  EXPECT_EQ(json["warnings"].size(), 0u) << json["warnings"];
  EXPECT_THAT(std::string(json["accuracy"]["reason"]), HasSubstr("limited by thin walls"));
}

TEST_F(KerfCarve, TargetMissedAtAThinWallIsAWarning) {
  write("rib.ngc", kRibProgram);
  write("s.json", rib_scene(R"({"target_mm": 0.3, "pitch_mm": 0.3})"));
  const auto fixed = report("--scene s.json --program rib.ngc");
  EXPECT_THAT(std::string(fixed["warnings"][0]), StartsWith("s.json: the target of 0.3 mm is not"));
  EXPECT_THAT(std::string(fixed["warnings"][0]), HasSubstr("accuracy.pitch_mm is 0.3 mm"));
}

TEST_F(KerfCarve, WarnsOfAGrooveNarrowerThanThePitch) {
  write("groove.ngc", "G21 G90 T1 M6\nF600\nG0 X-5 Y9 Z6\nG1 X25\nM2\n");
  std::string scene = rib_scene(R"({"pitch_mm": 0.3})");
  scene.replace(scene.find("_mm\": 3,"), 8, "_mm\": 0.14,");
  write("s.json", scene);
  const auto json = report("--scene s.json --program groove.ngc");
  ASSERT_EQ(json["warnings"].size(), 2u) << json["warnings"];
  EXPECT_THAT(std::string(json["warnings"][0]),
              StartsWith("groove.ngc:4: a groove of 0.14 mm at X"));
  EXPECT_THAT(std::string(json["warnings"][0]),
              HasSubstr("is narrower than the pitch of 0.3 mm and is missing in the result"));
  EXPECT_THAT(std::string(json["warnings"][1]), HasSubstr("NOTHING WAS CUT"));
  EXPECT_EQ(json["removed_volume_mm3"], 0);
  EXPECT_EQ(json["thin_walls"]["walls"][0]["kind"], "groove");
  EXPECT_EQ(report("--scene s.json --program groove.ngc --pitch 0.1")["thin_walls"]["count"], 0);
}

// A block with a fin of 0.14 mm on top, between the rays.
const char* const kFinStock = R"(o fin
v 0 0 0
v 9.83 0 0
v 9.97 0 0
v 20 0 0
v 20 0 5
v 9.97 0 5
v 9.97 0 10
v 9.83 0 10
v 9.83 0 5
v 0 0 5
v 0 20 0
v 9.83 20 0
v 9.97 20 0
v 20 20 0
v 20 20 5
v 9.97 20 5
v 9.97 20 10
v 9.83 20 10
v 9.83 20 5
v 0 20 5
f 1 2 9 10
f 2 3 6 9
f 3 4 5 6
f 9 6 7 8
f 20 19 12 11
f 19 16 13 12
f 16 15 14 13
f 18 17 16 19
f 11 12 2 1
f 12 13 3 2
f 13 14 4 3
f 14 15 5 4
f 15 16 6 5
f 16 17 7 6
f 17 18 8 7
f 18 19 9 8
f 19 20 10 9
f 20 11 1 10
)";

TEST_F(KerfCarve, WarnsOfAStockWallThinnerThanThePitch) {
  write("fin.obj", kFinStock);
  write("p.ngc", "G21 G90 T1 M6\nF600\nG0 X5 Y-5 Z4\nG1 Y25\nM2\n");
  const auto scene = [](const std::string& accuracy) {
    std::string text = rib_scene(accuracy);
    text.replace(text.find("\"box\""), text.find("}, \"acc") - text.find("\"box\""),
                 R"("mesh", "file": "fin.obj")");
    return text;
  };
  write("s.json", scene(R"({"pitch_mm": 0.3})"));
  const auto json = report("--scene s.json --program p.ngc");
  ASSERT_EQ(json["warnings"].size(), 1u) << json["warnings"];
  EXPECT_THAT(std::string(json["warnings"][0]), StartsWith("fin.obj: a wall of 0.14 mm at X9.9 Y"));
  EXPECT_THAT(std::string(json["warnings"][0]), HasSubstr("is missing in the result"));
  EXPECT_EQ(json["thin_walls"]["walls"][0]["place"], nullptr);
  write("s.json", scene(R"({"target_mm": 0.3})"));
  const auto refined = report("--scene s.json --program p.ngc");
  EXPECT_LE(refined["pitch_mm"], 0.142);
  EXPECT_EQ(refined["warnings"].size(), 0u) << refined["warnings"];
}

}  // namespace
}  // namespace kerf::carve_walls_test
