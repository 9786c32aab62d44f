// SPDX-License-Identifier: Apache-2.0
#include "server/formats/unit_question.h"

#include <nlohmann/json.hpp>

#include "tests/support/test.h"

namespace kerf::unit_question_test {
namespace {

/// A tetrahedron whose greatest side is `size`, as ASCII STL.
std::string tetrahedron(double size) {
  const std::string s = std::to_string(size);
  const std::string o = "vertex 0 0 0\n", x = "vertex " + s + " 0 0\n",
                    y = "vertex 0 " + s + " 0\n", z = "vertex 0 0 " + s + "\n";
  std::string text = "solid t\n";
  for (const std::string& corners : {o + y + x, o + x + z, x + y + z, y + o + z})
    text += "facet normal 0 0 0\nouter loop\n" + corners + "endloop\nendfacet\n";
  return text + "endsolid t\n";
}

std::vector<UnitQuestion> asked(double stock, double obstacle, const std::string& placement = "") {
  const std::string text = R"({"stock": {"shape": "mesh", "file": "part.stl")" + placement + R"(},
          "obstacles": [{"shape": "mesh", "file": "clamp.stl"}],
          "accuracy": {"rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
          "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60}]})";
  SceneSource source;
  source.files = {{"part.stl", tetrahedron(stock)}, {"clamp.stl", tetrahedron(obstacle)}};
  source.load_mesh = load_mesh;
  const auto scene = parse_scene(text, source);
  EXPECT_TRUE(scene) << to_string(scene.error());
  return scene ? unit_questions(*scene) : std::vector<UnitQuestion>{};
}

std::vector<std::string> fields(const std::vector<UnitQuestion>& questions) {
  std::vector<std::string> names;
  for (const UnitQuestion& question : questions) names.push_back(question.field);
  return names;
}

TEST(UnitQuestion, ALikelySizeIsNotQuestioned) {
  for (const double size : {1.0, 8.0, 40.0, 2000.0, 10'000.0})
    EXPECT_FALSE(unit_question("x", "a.stl", size)) << size;
  for (const double ratio : {1 / 30.0, 1 / 25.4, 1.0, 25.4, 250.0})
    EXPECT_FALSE(unit_question("x", "a.stl", 40 * ratio, 40)) << ratio;
  EXPECT_EQ(asked(40, 60).size(), 0U);
}

TEST(UnitQuestion, ModelInMetersRaisesAQuestion) {
  const auto question = test::value_of(unit_question("placement", "a.stl", 0.04));
  ASSERT_EQ(question.choices.size(), 3U);
  EXPECT_EQ(question.choices[2].unit, "m");
  EXPECT_NEAR(question.choices[2].size_mm, 40, 1e-12);
  EXPECT_EQ(question.text,
            "a.stl is 0.04 mm long if its numbers are mm: what is their unit? placement cm makes "
            "0.4 mm, inch makes 1.016 mm, m makes 40 mm");
  EXPECT_EQ(fields(asked(0.04, 0.05)),
            (std::vector<std::string>{"stock.placement", "obstacles[0].placement"}));
}

TEST(UnitQuestion, AModelIsComparedWithItsPartner) {
  for (const double size : {0.5, 4.0, 40.0, 400.0}) {
    EXPECT_EQ(test::value_of(unit_question("x", "a.stl", size, 1000 * size)).choices.size(), 3U);
    const auto large = test::value_of(unit_question("x", "a.stl", 1000 * size, size));
    ASSERT_EQ(large.choices.size(), 1U);
    EXPECT_EQ(large.choices[0].scale, 0.001);
    EXPECT_NEAR(large.choices[0].size_mm, size, 1e-9);
  }
  EXPECT_EQ(fields(asked(40, 40'000)), std::vector<std::string>{"obstacles[0].placement"});
}

TEST(UnitQuestion, StatedUnitIsNotQuestioned) {
  EXPECT_EQ(asked(0.04, 40, R"(, "placement": {"unit": "m"})").size(), 0U);
  EXPECT_EQ(asked(0.04, 40, R"(, "placement": {"scale": [1000, 1000, 1000]})").size(), 0U);
  const BoxStock tiny{{0, 0, 0}, {0.04, 0.01, 0.01}};
  MeshFile file;
  for (const char* name : {"a.3mf", "a.glb", "a.obj"}) {
    file.file = name;
    EXPECT_EQ(unit_question("x", file, tiny).has_value(), file.file == "a.obj");
  }
}

TEST(UnitQuestion, IsTypedInJson) {
  const auto json = nlohmann::json::parse(questions_json(asked(0.04, 40'000)));
  ASSERT_EQ(json.size(), 2U);
  EXPECT_EQ(json[0].at("field"), "stock.placement");
  EXPECT_EQ(json[0].at("choices").at(2).at("unit"), "m");
  EXPECT_EQ(json[1].at("choices").at(0).at("scale"), 0.001);
}

}  // namespace
}  // namespace kerf::unit_question_test
