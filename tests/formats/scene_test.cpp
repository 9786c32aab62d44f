// SPDX-License-Identifier: Apache-2.0
#include "server/formats/scene.h"

#include <unistd.h>

#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::scene_test {
namespace {

using testing::HasSubstr;

// A valid scene with one text replaced by another.
std::string with(const std::string& from, const std::string& to) {
  std::string text =
      R"({"name": "chips", "stock": {"shape": "box", "min_mm": [-50,-50,-50], "max_mm": [50,50,0]},
 "accuracy": {"rays": "dexel", "pitch_mm": 0.25, "tolerance_mm": 0.01, "motion": "tight"},
 "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60}],
 "force": {"law": "specific_energy", "specific_force_n_per_mm2": 0.5, "drr_n_s_per_mm3": 0.01, "pivot_mm": 60},
 "machine": {"kinematics": "xyzac-trt"}, "obstacles": []})";
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

SceneError error_of(const std::string& text) {
  auto scene = parse_scene(text, {.name = "s.json", .base_folder = {}});
  EXPECT_FALSE(scene.has_value()) << text;
  return scene ? SceneError{} : scene.error();
}

TEST(Scene, ExampleSceneIsRead) {
  const auto scene = test::value_of(parse_scene(with("chips", "chips"), {}));
  EXPECT_EQ(scene.name, "chips");
  EXPECT_EQ(std::get<BoxStock>(scene.settings.stock), (BoxStock{{-50, -50, -50}, {50, 50, 0}}));
  EXPECT_EQ(scene.settings.pitch_mm, 0.25);
  EXPECT_EQ(scene.tools.at(1).tool.radius_mm, 5);
  EXPECT_EQ(scene.machine.kinematics, MachineKinematics::kXyzacTrt);
}

TEST(Scene, OnlyStockAndToolsAreRequired) {
  const auto scene = test::value_of(parse_scene(
      R"({"stock": {"shape": "cylinder", "center_mm": [1, 2], "radius_mm": 20, "min_z_mm": 0, "max_z_mm": 9},
          "tools": [{"id": 7, "shape": "taper", "diameter_mm": 2, "half_angle_deg": 10, "length_mm": 20, "tip": "ball"},
                    {"id": 8, "shape": "cone_end", "diameter_mm": 6, "tip_angle_deg": 90, "length_mm": 20}]})",
      {}));
  EXPECT_EQ(std::get<CylinderStock>(scene.settings.stock), (CylinderStock{1, 2, 20, 0, 9}));
  EXPECT_EQ(scene.settings.tolerance_mm, 0.01);
  EXPECT_EQ(scene.settings.force.pivot_mm, 60);
  EXPECT_EQ(scene.machine.kinematics, MachineKinematics::kXyz);
  EXPECT_EQ(scene.machine.rapid_mm_per_min, 10000);
  EXPECT_EQ(error_of(R"({"tools": []})").path, "stock");
  EXPECT_EQ(
      error_of(with(R"("tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60}])",
                    R"("tools": [])"))
          .path,
      "tools");
}

TEST(Scene, CanonicalTextReadsBackEqual) {
  const auto scene = test::value_of(parse_scene(
      with(
          R"("obstacles": [])",
          R"("obstacles": [{"shape": "box", "min_mm": [0,0,0], "max_mm": [1,2,3], "stiffness_n_per_mm": 7},
 {"shape": "cylinder", "from_mm": [0,0,0], "to_mm": [0.1,0,9], "radius_mm": 2},
 {"shape": "sphere", "center_mm": [0,0,0], "radius_mm": 0.3}])"),
      {}));
  const std::string text = scene_json(scene);
  const auto again = test::value_of(parse_scene(text, {}));
  EXPECT_EQ(scene_json(again), text);
  ASSERT_EQ(again.settings.obstacles.size(), 3u);
  EXPECT_EQ(again.settings.obstacles[0].stiffness_n_per_mm, 7);
  EXPECT_EQ(again.settings.obstacles[1].stiffness_n_per_mm, 1);
  EXPECT_EQ(std::get<CylinderObstacle>(again.settings.obstacles[1].shape).to_mm.x, 0.1);
}

TEST(Scene, CanonicalTextStatesTheLimitsOfTheMachineOnlyIfTheyAreGiven) {
  const std::string limits =
      R"("feed_max_mm_per_min":[9000.0,8000.0,500.0],"acceleration_mm_per_s2":[500.0,400.0,90.0],)"
      R"("turn_max_rad_per_s":2.0,"turn_acceleration_rad_per_s2":5.0)";
  const auto given =
      test::value_of(parse_scene(with("\"machine\": {", "\"machine\": {" + limits + ", "), {}));
  EXPECT_THAT(scene_json(given), HasSubstr(limits));
  EXPECT_EQ(scene_json(test::scene_for("xyz")).find("acceleration"), std::string::npos);
}

TEST(Scene, RaysAreDexelOrTriDexel) {
  const auto three = test::value_of(parse_scene(with("\"dexel\"", "\"tri-dexel\""), {}));
  EXPECT_EQ(three.settings.rays, Rays::kTriDexel);
  EXPECT_EQ(parse_scene(scene_json(three), {})->settings.rays, Rays::kTriDexel);
  const auto one = parse_scene(with("\"dexel\"", "\"dexel\""), {});
  EXPECT_EQ(parse_scene(scene_json(*one), {})->settings.rays, Rays::kDexel);
}

TEST(Scene, PartsAreCanonicalJson) {
  const Scene scene = test::scene_for("xyz");
  EXPECT_EQ(stock_json(scene),
            R"({"shape":"box","min_mm":[-50.0,-50.0,-50.0],"max_mm":[50.0,50.0,0.0]})");
  EXPECT_EQ(
      force_json(scene),
      R"({"law":"specific_energy","specific_force_n_per_mm2":0.5,"drr_n_s_per_mm3":0.0005,"pivot_mm":60.0,"contact_stiffness_n_per_mm":1.0})");
  EXPECT_THAT(tools_json(scene), HasSubstr(R"({"id":2,"shape":"flat","diameter_mm":10.0)"));
}

TEST(Scene, MaterialSetsTheUnstatedCoefficients) {
  const auto scene =
      test::value_of(parse_scene(with("\"specific_energy\"",
                                      "\"mechanistic\", \"material\": \"aluminium-7075\", "
                                      "\"teeth\": 3, \"radial_n_per_mm2\": 170.5"),
                                 {}));
  const MillingSettings& milling = scene.settings.force.milling;
  EXPECT_EQ(milling.teeth, 3);
  EXPECT_EQ(milling.cut_n_per_mm2.tangential, 767.01);
  EXPECT_EQ(milling.cut_n_per_mm2.radial, 170.5);
  EXPECT_EQ(milling.edge_n_per_mm.radial, 26.6);
  // Agents and journals contain the coefficients, not the name, because presets may change.
  EXPECT_EQ(force_json(test::value_of(parse_scene(scene_json(scene), {}))), force_json(scene));
  EXPECT_THAT(force_json(scene), HasSubstr("\"radial_edge_n_per_mm\":26.6"));
}

TEST(Scene, ChipExponentsApplyToAllDirectionsOrEach) {
  const auto exponents_of = [](const std::string& fields) {
    const auto scene = parse_scene(with("\"specific_energy\"", "\"mechanistic\", " + fields), {});
    EXPECT_TRUE(scene) << to_string(scene.error());
    const auto again = parse_scene(scene_json(*scene), {});
    EXPECT_EQ(force_json(*again), force_json(*scene));
    return again->settings.force.milling.chip_exponents;
  };
  const std::string oak = R"("material": "oak")";
  EXPECT_EQ(exponents_of(oak), in_all_directions(0.5));
  EXPECT_EQ(exponents_of(oak + R"(, "chip_exponent": 0.2)"), in_all_directions(0.2));
  EXPECT_EQ(exponents_of(oak + R"(, "radial_chip_exponent": 0.6)"),
            (EdgeCoefficients{0.5, 0.6, 0.5}));
  EXPECT_EQ(exponents_of(oak + R"(, "chip_exponent": 0.2, "tangential_chip_exponent": 0.3,
                                    "axial_chip_exponent": 0.1)"),
            (EdgeCoefficients{0.3, 0.2, 0.1}));
}

TEST(Scene, ForcesOfTheReadmeAreRead) {
  std::string readme = test::content_of(KERF_SOURCE_DIR "/server/formats/README.md");
  const std::string given =
      R"("force": {"law": "specific_energy", "specific_force_n_per_mm2": 0.5, "drr_n_s_per_mm3": 0.01, "pivot_mm": 60})";
  const std::string begin = "```json\n\"force\": ", end = "\n```";
  std::vector<MillingSettings> read;
  for (auto at = readme.find(begin); at != readme.npos; at = readme.find(begin, at + 1)) {
    const auto from = at + begin.size() - std::string("\"force\": ").size();
    const auto scene = test::value_of(
        parse_scene(with(given, readme.substr(from, readme.find(end, at) - from)), {}));
    EXPECT_EQ(scene.settings.force.law, ForceLaw::kMechanistic);
    read.push_back(scene.settings.force.milling);
  }
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].cut_n_per_mm2.tangential, 33);  // beech
  EXPECT_EQ(read[1].cut_n_per_mm2.tangential, 625.1);
  EXPECT_EQ(read[1].chip_exponents, (EdgeCoefficients{0.25, 0.55, 0.7}));
  EXPECT_EQ(read[1].scale, 0.05);
}

struct BadScene {
  const char* from;
  const char* to;
  const char* path;
  const char* reason;
};

class BadScenes : public testing::TestWithParam<BadScene> {};

TEST_P(BadScenes, AreRejectedWithPathAndReason) {
  const SceneError error = error_of(with(GetParam().from, GetParam().to));
  EXPECT_EQ(error.file, "s.json");
  EXPECT_EQ(error.path, GetParam().path);
  EXPECT_THAT(error.reason, HasSubstr(GetParam().reason));
}

INSTANTIATE_TEST_SUITE_P(
    Scene, BadScenes,
    testing::Values(
        BadScene{R"("name": "chips")", R"("nmae": "chips")", "nmae", "not a field"},
        BadScene{R"("name": "chips")", R"("name": 3)", "name", "string"},
        BadScene{R"("shape": "box")", R"("shape": "torus")", "stock.shape", "torus"},
        BadScene{R"("shape": "box")", R"("shape": "stl")", "stock.file", "missing"},
        BadScene{"[-50,-50,-50]", "[-50,-50]", "stock.min_mm", "3 numbers"},
        BadScene{"[-50,-50,-50]", "[-50,-50,\"a\"]", "stock.min_mm[2]", "number"},
        BadScene{"[50,50,0]", "[50,-50,0]", "stock.max_mm", "greater"},
        BadScene{"\"pitch_mm\": 0.25", "\"pitch_mm\": 0", "accuracy.pitch_mm", "above 0"},
        BadScene{"\"pitch_mm\": 0.25", "\"pitch_mm\": \"x\"", "accuracy.pitch_mm", "number"},
        BadScene{"\"dexel\"", "\"voxel\"", "accuracy.rays", "voxel"},
        BadScene{"\"tight\"", "\"loose\"", "accuracy.motion", "loose"},
        BadScene{"\"id\": 1", "\"id\": 0", "tools[0].id", "above 0"},
        BadScene{"\"id\": 1", "\"id\": 1.5", "tools[0].id", "integer"},
        BadScene{"\"ball\"", "\"spoon\"", "tools[0].shape", "spoon"},
        BadScene{"\"length_mm\": 60", "\"length_mm\": 1", "tools[0].length_mm", ""},
        BadScene{"\"length_mm\": 60}", "\"length_mm\": 60}, {\"id\": 1}", "tools[1].id", "already"},
        BadScene{"\"specific_energy\"", "\"magic\"", "force.law", "magic"},
        BadScene{"\"pivot_mm\": 60", "\"pivot_mm\": -1", "force.pivot_mm", "negative"},
        BadScene{"\"specific_energy\"", "\"mechanistic\"", "force.material", "missing"},
        BadScene{"\"specific_energy\"", "\"mechanistic\", \"material\": \"cheese\"",
                 "force.material", "beech"},
        BadScene{"\"specific_energy\"", "\"drr\", \"teeth\": 2", "force.teeth", "mechanistic"},
        BadScene{"\"specific_energy\"", "\"mechanistic\", \"material\": \"oak\", \"teeth\": 1.5",
                 "force.teeth", "whole"},
        BadScene{"\"specific_energy\"",
                 "\"mechanistic\", \"material\": \"oak\", \"spindle_rpm\": 0", "force.spindle_rpm",
                 "above 0"},
        BadScene{"\"specific_energy\"",
                 "\"mechanistic\", \"material\": \"oak\", \"spindle_rpm\": 1e-300",
                 "force.spindle_rpm", "from 1"},
        BadScene{"\"specific_energy\"",
                 "\"mechanistic\", \"material\": \"oak\", \"chip_exponent\": 1",
                 "force.chip_exponent", "0.9"},
        BadScene{"\"specific_energy\"",
                 "\"mechanistic\", \"material\": \"oak\", \"axial_chip_exponent\": 1",
                 "force.axial_chip_exponent", "0.9"},
        BadScene{"\"specific_energy\"",
                 "\"mechanistic\", \"material\": \"oak\", \"runout_mm\": -0.1", "force.runout_mm",
                 "negative"},
        BadScene{"\"xyzac-trt\"", "\"xyz\", \"acceleration_mm_per_s2\": [1, 0, 1]",
                 "machine.acceleration_mm_per_s2", "above 0 on each axis"},
        BadScene{"xyzac-trt", "hexapod", "machine.kinematics", "hexapod"},
        BadScene{"\"obstacles\": []", "\"obstacles\": {}", "obstacles", "list"},
        BadScene{"\"obstacles\": []", "\"obstacles\": [{\"shape\": \"cone\"}]",
                 "obstacles[0].shape", "cone"},
        BadScene{"\"obstacles\": []",
                 "\"obstacles\": [{\"shape\": \"stl\", \"file\": \"/etc/passwd\"}]",
                 "obstacles[0].file", "may not name a file"},
        BadScene{"\"name\": \"chips\"", "\"name\": \"a\", \"name\": \"b\"", "name", "twice"}));

TEST(Scene, SyntaxErrorsHaveLineAndColumn) {
  const SceneError error = error_of("{\n  \"name\": nonsense\n}");
  EXPECT_EQ(error.line, 2u);
  EXPECT_EQ(error.column, 12u);
  EXPECT_THAT(to_string(error), HasSubstr("s.json:2:12:"));
  error_of("");
  error_of("[]");
  error_of("{\"stock\": 1e999}");
  error_of(std::string(100000, '['));
}

TEST(Scene, ValidationErrorsHaveTheLineOfTheValue) {
  const SceneError error = error_of(with("\"pitch_mm\": 0.25", "\n\n  \"pitch_mm\":\n 0"));
  EXPECT_EQ(error.line, 5u);
  EXPECT_EQ(error.column, 2u);
  EXPECT_EQ(error_of(with("\"id\": 1", "\n\"id\": 0")).line, 4u);
  EXPECT_EQ(error_of(with("50,50,0]", "50,\n\"a \\\" ] }\",0]")).line, 2u);
  // The error of a missing field has the position of the enclosing object.
  EXPECT_EQ(error_of(with("\"diameter_mm\": 10,", "\n")).line, 3u);
  EXPECT_EQ(error_of("\n\n []").line, 3u);
}

TEST(Scene, SceneFilesOfTheTestsAreRead) {
  for (const char* name : {"chips", "boat"}) {
    const auto scene = test::value_of(
        load_scene(std::string(KERF_SOURCE_DIR "/tests/formats/scenes/") + name + ".json"));
    EXPECT_EQ(scene.name, name);
  }
}

TEST(Scene, ExplainListsEveryFieldWithItsMeaning) {
  const auto scene = test::value_of(parse_scene(
      with(
          R"("obstacles": [])",
          R"("obstacles": [{"shape": "cylinder", "from_mm": [0,0,0], "to_mm": [0,0,9], "radius_mm": 2},
              {"shape": "sphere", "center_mm": [0,0,0], "radius_mm": 2}])"),
      {}));
  std::istringstream lines(explain_scene(scene));
  std::string line;
  int count = 0;
  while (std::getline(lines, line)) {
    ++count;
    // The line of a field without help ends after its value.
    EXPECT_FALSE(line.ends_with(' ')) << line;
  }
  EXPECT_EQ(count, 33);
}

}  // namespace
}  // namespace kerf::scene_test
