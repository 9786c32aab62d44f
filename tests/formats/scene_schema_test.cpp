// SPDX-License-Identifier: Apache-2.0
#include <regex>

#include "server/formats/scene.h"
#include "server/formats/scene_templates.h"
#include "tests/formats/json_schema.h"
#include "tests/support/test.h"

namespace kerf::scene_schema_test {
namespace {

using Json = nlohmann::json;
using test::SchemaFault;

Json read_json(const std::filesystem::path& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file.is_open()) << path;
  return Json::parse(file);
}

const test::JsonSchema& schema() {
  static const test::JsonSchema kSchema(
      read_json(KERF_SOURCE_DIR "/server/formats/scene.schema.json"));
  return kSchema;
}

/// Scenes that together contain every field.
std::vector<Json> every_field() {
  const char* const stocks[] = {
      R"({"shape": "box", "min_mm": [0, 0, 0], "max_mm": [9, 9, 9]})",
      R"({"shape": "cylinder", "center_mm": [0, 0], "radius_mm": 5, "min_z_mm": 0, "max_z_mm": 9})",
      R"({"shape": "mesh", "file": "m.stl", "repair": true, "placement": {"unit": "inch",
          "scale": [1, 2, 3], "rotate_deg": [0, 90, 0], "translate_mm": [1, 2, 3]}})"};
  const char* const forces[] = {
      R"({"law": "drr", "drr_n_s_per_mm3": 0.1, "specific_force_n_per_mm2": 1, "pivot_mm": 3,
          "contact_stiffness_n_per_mm": 1})",
      R"({"pivot_mm": 3})",
      R"({"law": "mechanistic", "material": "beech", "spindle_rpm": 9000, "teeth": 2,
          "helix_deg": 30, "feed_per_tooth_mm": 0, "runout_mm": 0, "ripple_hz": 250, "scale": 0.5,
          "tangential_n_per_mm2": 1, "radial_n_per_mm2": 1, "axial_n_per_mm2": 1,
          "tangential_edge_n_per_mm": 1, "radial_edge_n_per_mm": 1, "axial_edge_n_per_mm": 1,
          "chip_exponent": 0.2, "tangential_chip_exponent": 0.2, "radial_chip_exponent": 0.2,
          "axial_chip_exponent": 0.2})"};
  const Json rest = Json::parse(R"({
    "$schema": "scene.schema.json", "name": "n",
    "accuracy": {"target_mm": 0.5, "rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01,
                 "motion": "paper"},
    "machine": {"kinematics": "tool-vector", "dialect": "haas", "rotary_direction": "tool", "spindle_tool": 1, "rapid_mm_per_min": 9000,
                "feed_max_mm_per_min": [9000, 8000, 500], "acceleration_mm_per_s2": [500, 400, 90],
                "turn_max_rad_per_s": 2, "turn_acceleration_rad_per_s2": 5},
    "tools": [
      {"id": 1, "shape": "ball", "diameter_mm": 4, "length_mm": 20,
       "shank": {"diameter_mm": 3, "length_mm": 9},
       "holder": [{"diameter_mm": 20, "top_diameter_mm": 22, "length_mm": 9}]},
      {"id": 2, "shape": "flat", "diameter_mm": 4, "length_mm": 20,
       "holder": {"profile_mm": [[0, 0], [9, 0], [9, 9]], "chord_tolerance_mm": 0.1}},
      {"id": 3, "shape": "bull_nose", "diameter_mm": 8, "corner_radius_mm": 1, "length_mm": 20},
      {"id": 4, "shape": "taper", "diameter_mm": 3, "half_angle_deg": 5, "length_mm": 20,
       "tip": "ball"},
      {"id": 5, "shape": "cone_end", "diameter_mm": 4, "tip_angle_deg": 90, "length_mm": 20},
      {"id": 6, "shape": "apt", "d_mm": 10, "r_mm": 1, "e_mm": 4, "f_mm": 1, "alpha_deg": 0,
       "beta_deg": 0, "h_mm": 30},
      {"id": 7, "shape": "profile", "chord_tolerance_mm": 0.1, "profile_mm":
       [[0, 0], {"to": [3, 3], "radius": 3, "bulge": "out"},
        {"to": [4, 4], "center": [3, 4], "bulge": "out"}, [4, 30]]}],
    "obstacles": [
      {"shape": "box", "min_mm": [30, 0, 0], "max_mm": [40, 9, 9], "stiffness_n_per_mm": 2},
      {"shape": "cylinder", "from_mm": [30, 0, 0], "to_mm": [30, 0, 9], "radius_mm": 3},
      {"shape": "sphere", "center_mm": [30, 0, 0], "radius_mm": 3},
      {"shape": "stl", "file": "m.stl", "repair": false, "placement": {}}],
    "guides": [
      {"kind": "path", "file": "p.ngc", "within_mm": 3, "axis_within_deg": 15,
       "turn_stiffness_nmm_per_rad": 100, "max_torque_nmm": 50, "stiffness_n_per_mm": 1,
       "max_force_n": 2},
      {"kind": "stroke", "paths": [[[0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0]]], "felt_share": 0.5},
      {"kind": "plane", "point_mm": [0, 0, 0], "normal": [0, 0, 1]},
      {"kind": "depth", "lowest_z_mm": -7},
      {"kind": "region", "min_mm": [0, 0, 0], "max_mm": [5, 5, 5]},
      {"kind": "snap", "range_mm": 5, "surface": {"shape": "box", "min_mm": [0, 0, 0],
       "max_mm": [9, 9, 9]}}]})");
  std::vector<Json> scenes;
  for (std::size_t n = 0; n < std::size(stocks); ++n) {
    Json scene = rest;
    scene["stock"] = Json::parse(stocks[n]);
    scene["force"] = Json::parse(forces[n]);
    scenes.push_back(scene);
  }
  return scenes;
}

/// Returns why the reader rejects a scene. Empty if it accepts it.
std::string rejection(const Json& scene) {
  static const std::string kMesh =
      "solid m\n"
      "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 9 0 vertex 9 0 0 endloop endfacet\n"
      "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 9 0 0 vertex 0 0 9 endloop endfacet\n"
      "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 0 9 vertex 0 9 0 endloop endfacet\n"
      "facet normal 0 0 0 outer loop vertex 9 0 0 vertex 0 9 0 vertex 0 0 9 endloop endfacet\n"
      "endsolid m\n";
  const auto read = parse_scene(
      scene.dump(), {.base_folder = {},
                     .files = {{"m.stl", kMesh}, {"p.ngc", "T1 M6\nG0 X0 Y0 Z9\nG1 Z0 F9\nM2\n"}},
                     .load_mesh = load_mesh});
  return read ? "" : read.error().path + " " + read.error().reason;
}

// Adds the paths of all values of a document, except those in lists of numbers.
void add_places(const Json& value, const std::string& at, std::vector<std::string>& places) {
  places.push_back(at);
  if (value.is_array() && !value.empty() && value[0].is_number()) return;
  if (value.is_object())
    for (const auto& [name, member] : value.items()) add_places(member, at + "/" + name, places);
  for (std::size_t n = 0; value.is_array() && n < value.size(); ++n)
    add_places(value[n], at + "/" + std::to_string(n), places);
}

// Returns the paths of the n-th scene; for scenes after the first only where they differ from it.
std::vector<std::string> places_of(std::size_t n, const Json& scene) {
  std::vector<std::string> places;
  if (n == 0) {
    add_places(scene, "", places);
  } else {
    add_places(scene["stock"], "/stock", places);
    add_places(scene["force"], "/force", places);
  }
  return places;
}

std::string text_of(const std::vector<SchemaFault>& faults) {
  std::string text;
  for (const SchemaFault& fault : faults) text += fault.path + ": " + fault.keyword + "\n";
  return text;
}

TEST(SceneSchema, AcceptsEveryFieldAndEveryShippedScene) {
  for (const Json& scene : every_field()) {
    EXPECT_EQ(rejection(scene), "");
    EXPECT_EQ(text_of(schema().faults(scene)), "") << scene;
  }
  std::vector<std::filesystem::path> files = {KERF_SOURCE_DIR "/haptic_agent/demo/demo.json",
                                              KERF_SOURCE_DIR "/tests/package/pocket.json"};
  for (const auto& entry :
       std::filesystem::directory_iterator(KERF_SOURCE_DIR "/tests/formats/scenes"))
    files.push_back(entry.path());
  EXPECT_GE(files.size(), 6U);
  for (const auto& file : files) EXPECT_EQ(text_of(schema().faults(read_json(file))), "") << file;
  for (const SceneTemplate& one : scene_templates()) {
    EXPECT_EQ(text_of(schema().faults(Json::parse(one.scene))), "") << one.id;
    const auto scene = parse_scene(one.scene, {});
    EXPECT_EQ(text_of(schema().faults(Json::parse(scene_json(*scene)))), "") << one.id;
  }
}

TEST(SceneSchema, IsNamedByTheScenesOfTheProject) {
  const std::filesystem::path folder = KERF_SOURCE_DIR "/tests/formats/scenes";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string named = read_json(entry.path())["$schema"];
    EXPECT_EQ(read_json(folder / named)["title"], "Scene of Kerf") << entry.path();
  }
  // With the paths of the installed files (docker/install.cmake).
  EXPECT_EQ(read_json(KERF_SOURCE_DIR "/haptic_agent/demo/demo.json")["$schema"],
            "../scene.schema.json");
}

TEST(SceneSchema, KnowsTheSameFieldsAsTheReader) {
  std::set<std::string> names = {"unknown"};
  const std::vector<Json> scenes = every_field();
  for (std::size_t n = 0; n < scenes.size(); ++n) {
    for (const std::string& place : places_of(n, scenes[n]))
      names.insert(place.substr(place.rfind('/') + 1));
  }
  std::size_t known = 0;
  for (std::size_t n = 0; n < scenes.size(); ++n) {
    const Json& scene = scenes[n];
    for (const std::string& place : places_of(n, scene)) {
      const Json::json_pointer at(place);
      if (!scene[at].is_object()) continue;
      for (const std::string& name : names) {
        if (name.find_first_not_of("0123456789") == name.npos || scene[at].contains(name)) continue;
        // A null is a valid value of no field: known fields are rejected for their type.
        Json changed = scene;
        changed[at][name] = nullptr;
        const std::string reason = rejection(changed);
        ASSERT_NE(reason, "") << place << " " << name;
        const bool read = reason.find("is not a field of a scene") == reason.npos &&
                          reason.find("belongs to the force law") == reason.npos &&
                          reason.find("either radius or center") == reason.npos;
        bool listed = true;
        for (const SchemaFault& fault : schema().faults(changed))
          if (fault.path == place + "/" + name && fault.keyword == "additionalProperties")
            listed = false;
        EXPECT_EQ(read, listed) << place << "/" << name << ": " << reason;
        known += listed ? 1 : 0;
      }
    }
  }
  EXPECT_GT(known, 0U);
}

TEST(SceneSchema, AcceptsWhateverTheReaderAccepts) {
  const Json values[] = {nullptr, true,          "x",           -1, 0, 1.5, 100, 400,
                         2e6,     Json::array(), Json::object()};
  std::size_t broken = 0;
  const std::vector<Json> scenes = every_field();
  for (std::size_t n = 0; n < scenes.size(); ++n) {
    const Json& scene = scenes[n];
    for (const std::string& place : places_of(n, scene)) {
      if (place.empty()) continue;
      const Json::json_pointer at(place);
      for (std::size_t v = 0; v <= std::size(values); ++v) {
        Json changed = scene;
        if (v < std::size(values)) {
          changed[at] = values[v];
        } else if (changed[at.parent_pointer()].is_object()) {
          changed[at.parent_pointer()].erase(at.back());
        }
        const std::string reason = rejection(changed);
        const std::string faults = text_of(schema().faults(changed));
        EXPECT_TRUE(!reason.empty() || faults.empty()) << place << ": " << faults << changed;
        // A wrong type or a missing field is an error for both.
        static const std::regex kStructural(
            "must be (a (finite )?number|a string|a list|an object|true or false)|is missing$");
        const bool structural = std::regex_search(reason, kStructural);
        EXPECT_TRUE(!structural || !faults.empty()) << place << ": " << reason;
        broken += faults.empty() ? 0 : 1;
      }
    }
  }
  EXPECT_GT(broken, 1000U);
}

}  // namespace
}  // namespace kerf::scene_schema_test
