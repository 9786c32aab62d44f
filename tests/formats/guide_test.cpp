// SPDX-License-Identifier: Apache-2.0
#include "server/formats/guide.h"

#include "server/formats/guide_json.h"
#include "server/formats/guide_paths.h"
#include "server/formats/guide_reader.h"
#include "server/formats/scene.h"
#include "tests/support/test.h"

namespace kerf::guide_test {
namespace {

using testing::HasSubstr;

std::string scene_with(const std::string& guides, const std::string& stock = R"({"shape": "box",
    "min_mm": [-20, -20, -20], "max_mm": [20, 20, 0]})") {
  return R"({"name": "guided", "stock": )" + stock +
         R"(, "tools": [{"id": 1, "shape": "ball", "diameter_mm": 6, "length_mm": 40}],
            "guides": )" +
         guides + "}";
}

const std::string kProgram =
    "G21 G90 G17\nT1 M6\nG0 X0 Y0 Z5\nG1 Z-1 F600\nG1 X5\nG1 X10\nG1 X10 Y10\nG0 Z5\n"
    "G0 X-5\nG1 Z-2\nG1 X-10\nM2\n";

const std::string kForces =
    "t_s,x,y,z,i,j,k,fx_n,fy_n,fz_n,tx_nmm,ty_nmm,tz_nmm,removed_mm3,imprint_mm3\n"
    "0.1,0,0,1,0,0,1,0,0,0,0,0,0,0,0\n"
    "0.2,1,0,-1,0,0,1,-1,0,0.5,0,-60,0,2,0\n"
    "0.3,1.01,0,-1,0,0,1,-1,0,0.5,0,-60,0,0.1,0\n"
    "0.4,3,0,-1,0,0,2,-1.5,0,0.5,0,-90,0,2,0\n"
    "0.5,3,0,4,0,0,1,0,0,0,0,0,0,0,0\n"
    "0.6,8,0,-1,0,0,1,-2,0,0,0,-120,0,3,0\n";

Scene parsed(const std::string& guides, const SceneSource& source = {}) {
  auto scene = parse_scene(scene_with(guides), source);
  EXPECT_TRUE(scene.has_value()) << to_string(scene.error());
  return scene ? *std::move(scene) : Scene{};
}

TEST(Guides, AreReadWithTheirDefaults) {
  const Scene scene = parsed(
      R"([{"kind": "plane", "point_mm": [0, 0, -5], "normal": [0, 0, 2]},
          {"kind": "depth", "lowest_z_mm": -7, "stiffness_n_per_mm": 0.5, "max_force_n": 4},
          {"kind": "region", "min_mm": [0, 0, -9], "max_mm": [5, 5, 0]},
          {"kind": "snap"},
          {"kind": "path", "paths": [[[0, 0, 0, 0, 0, 1], [9, 0, 0, 0, 3, 4]]]}])");
  ASSERT_EQ(scene.guides.size(), 5U);
  EXPECT_EQ(std::get<PlaneGuide>(scene.guides[0].shape).normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(scene.guides[0].stiffness_n_per_mm, 1);
  EXPECT_EQ(scene.guides[1].stiffness_n_per_mm, 0.5);
  EXPECT_EQ(scene.guides[1].max_force_n, 4);
  const auto surface = std::get<SnapGuide>(scene.guides[3].shape).surface;
  ASSERT_TRUE(surface.has_value()) << "that of the stock";
  EXPECT_EQ(surface->min_mm, (Vec3{-20, -20, -20}));
  const auto& path = std::get<PathGuide>(scene.guides[4].shape);
  EXPECT_EQ(path.within_mm, 3);
  EXPECT_EQ(path.paths.front().back().axis, (Vec3{0, 0.6, 0.8}));
}

TEST(Guides, ProgramGuidesFollowCutsAndNotRapids) {
  const SceneSource source{
      .base_folder = {}, .files = {{"part.ngc", kProgram}}, .keep_files = true};
  const Scene scene = parsed(R"([{"kind": "path", "file": "part.ngc", "within_mm": 2}])", source);
  const auto& paths = std::get<PathGuide>(scene.guides.front().shape).paths;
  ASSERT_EQ(paths.size(), 2U);
  ASSERT_EQ(paths[0].size(), 4U) << "the two motions on one line are joined";
  EXPECT_EQ(paths[0][0].tip_mm, (Vec3{0, 0, 5}));
  EXPECT_EQ(paths[0][3].tip_mm, (Vec3{10, 10, -1}));
  EXPECT_EQ(paths[1][0].tip_mm, (Vec3{-5, 10, 5}));
  EXPECT_EQ(scene.files.at("part.ngc"), kProgram) << "a journal needs it";
}

TEST(Guides, StrokeGuidesHaveTheTeachersForces) {
  const SceneSource source{.base_folder = {}, .files = {{"teacher.csv", kForces}}};
  const Scene scene = parsed(R"([{"kind": "stroke", "file": "teacher.csv"}])", source);
  const auto& paths = std::get<PathGuide>(scene.guides.front().shape).paths;
  ASSERT_EQ(paths.size(), 2U);
  ASSERT_EQ(paths[0].size(), 3U) << "a row 0.01 mm after the last is omitted";
  EXPECT_EQ(paths[0][0].tip_mm, (Vec3{0, 0, 1})) << "where the first motion begins";
  EXPECT_EQ(paths[0][2].felt, (Wrench{{-1.5, 0, 0.5}, {0, -90, 0}}));
  EXPECT_EQ(paths[0][2].axis, (Vec3{0, 0, 1}));
  EXPECT_EQ(paths[1].front().tip_mm, (Vec3{3, 0, 4}));
}

TEST(Guides, CanonicalTextReadsBackToTheSameGuides) {
  const SceneSource source{.base_folder = {},
                           .files = {{"part.ngc", kProgram}, {"teacher.csv", kForces}}};
  const std::string text =
      R"([{"kind": "path", "file": "part.ngc", "axis_within_deg": 12}, {"kind": "snap"},
          {"kind": "stroke", "file": "teacher.csv", "felt_share": 0.5}])";
  const Scene scene = parsed(text, source);
  const std::string canonical = scene_json(scene);
  EXPECT_THAT(canonical, HasSubstr(R"("file":"part.ngc")"));
  EXPECT_EQ(scene_json(test::value_of(parse_scene(canonical, source))), canonical);
  const std::string expanded = guides_json(scene.guides, GuideFiles::kExpanded);
  const auto welcome = test::value_of(parse_guides(R"({"guides":)" + expanded + "}"));
  EXPECT_EQ(guides_json(welcome, GuideFiles::kExpanded), expanded);
  EXPECT_EQ(parse_guides("{}")->size(), 0U);
}

TEST(Guides, SceneWithoutGuidesKeepsItsText) {
  const Scene scene = parsed("[]");
  EXPECT_EQ(scene_json(scene).find("guides"), std::string::npos);
  EXPECT_THAT(explain_scene(scene), HasSubstr("virtual fixtures"));
}

struct BadGuide {
  const char* guides;
  const char* path;
  const char* reason;
};
class BadGuides : public testing::TestWithParam<BadGuide> {};

TEST_P(BadGuides, AreRejectedWithPathAndReason) {
  const SceneSource source{
      .base_folder = {},
      .files = {{"bad.csv", "t_s,x\n"},
                {"text.csv", kForces + "a,b\n"},
                {"bad.ngc", "G999\n"},
                {"far.csv", kForces + "0.7,9,2e6,0,0,0,1,0,0,0,0,0,0,1,0\n"},
                {"strong.csv", kForces + "0.7,9,0,0,0,0,1,2e6,0,0,0,0,0,1,0\n"},
                {"long.csv", kForces + "0.7,9,0,0,0,0,1e200,0,0,0,0,0,0,1,0\n"},
                {"far.ngc", "T1 M6\nG0 X0 Y0 Z5\nG1 X1 F600\nG1 X2000000\nM2\n"},
                {"air.ngc", "G0 X1 Y1 Z1\nM2\n"}}};
  const auto error = test::error_of(parse_scene(scene_with(GetParam().guides), source));
  EXPECT_EQ(error.path, GetParam().path);
  EXPECT_THAT(error.reason, HasSubstr(GetParam().reason));
}

INSTANTIATE_TEST_SUITE_P(
    Guides, BadGuides,
    testing::Values(
        BadGuide{R"([{"kind": "rail"}])", "guides[0].kind", "not a kind of guide"},
        BadGuide{R"([{"kind": "depth", "lowest_mm": 1}])", "guides[0].lowest_z_mm", "missing"},
        BadGuide{R"([{"kind": "depth", "lowest_z_mm": 1, "z": 1}])", "guides[0].z", "not a field"},
        BadGuide{R"([{"kind": "plane", "point_mm": [0,0,0], "normal": [0,0,0]}])",
                 "guides[0].normal", "zero"},
        BadGuide{R"([{"kind": "region", "min_mm": [0,0,0], "max_mm": [1,0,1]}])",
                 "guides[0].max_mm", "greater"},
        BadGuide{R"([{"kind": "snap", "range_mm": -1}])", "guides[0].range_mm", "above 0"},
        BadGuide{R"([{"kind": "snap", "surface": {"shape": "cone", "min_mm": [0,0,0],
                      "max_mm": [1,1,1]}}])",
                 "guides[0].surface.shape", "box or cylinder"},
        BadGuide{R"([{"kind": "depth", "lowest_z_mm": 1, "stiffness_n_per_mm": 101}])",
                 "guides[0].stiffness_n_per_mm", "at most 100"},
        BadGuide{R"([{"kind": "depth", "lowest_z_mm": 1, "max_force_n": 51}])",
                 "guides[0].max_force_n", "at most 50"},
        BadGuide{R"([{"kind": "depth", "lowest_z_mm": -1e308}])", "guides[0].lowest_z_mm",
                 "beyond"},
        BadGuide{R"([{"kind": "plane", "point_mm": [0,1e7,0], "normal": [0,0,1]}])",
                 "guides[0].point_mm", "beyond"},
        BadGuide{R"([{"kind": "plane", "point_mm": [0,0,0], "normal": [1e200,0,0]}])",
                 "guides[0].normal", "longer"},
        BadGuide{R"([{"kind": "region", "min_mm": [0,0,0], "max_mm": [1,1,1e200]}])",
                 "guides[0].max_mm", "beyond"},
        BadGuide{R"([{"kind": "snap", "range_mm": 1e7}])", "guides[0].range_mm", "at most"},
        BadGuide{R"([{"kind": "snap", "surface": {"shape": "cylinder", "min_mm": [-1e200,0,0],
                      "max_mm": [1,1,1]}}])",
                 "guides[0].surface.min_mm", "beyond"},
        BadGuide{R"([{"kind": "path", "within_mm": 1e7, "paths": [[[0,0,0,0,0,1]]]}])",
                 "guides[0].within_mm", "at most"},
        BadGuide{R"([{"kind": "path", "paths": [[[0,0,0,0,0,1], [0,0,-1e160,0,0,1]]]}])",
                 "guides[0].paths[0][1]", "beyond"},
        BadGuide{R"([{"kind": "path", "paths": [[[0,0,0,0,1e200,1]]]}])", "guides[0].paths[0][0]",
                 "longer"},
        BadGuide{R"([{"kind": "stroke", "paths": [[[0,0,0,0,0,1,1e308,0,0,0,0,0]]]}])",
                 "guides[0].paths[0][0]", "force or torque"},
        BadGuide{R"([{"kind": "stroke", "paths": [[[0,0,0,0,0,1,0,0,0,0,0,-2e6]]]}])",
                 "guides[0].paths[0][0]", "force or torque"},
        BadGuide{R"([{"kind": "stroke", "felt_share": 11,
                      "paths": [[[0,0,0,0,0,1,0,0,0,0,0,0]]]}])",
                 "guides[0].felt_share", "at most 10"},
        BadGuide{R"([{"kind": "stroke", "file": "far.csv"}])", "guides[0].file", "beyond"},
        BadGuide{R"([{"kind": "stroke", "file": "strong.csv"}])", "guides[0].file",
                 "force or torque"},
        BadGuide{R"([{"kind": "stroke", "file": "long.csv"}])", "guides[0].file", "line 8"},
        BadGuide{R"([{"kind": "path", "file": "far.ngc"}])", "guides[0].file",
                 "the limit is 1000000"},
        BadGuide{R"([{"kind": "path"}])", "guides[0].file", "missing"},
        BadGuide{R"([{"kind": "path", "paths": []}])", "guides[0].paths", "at least one path"},
        BadGuide{R"([{"kind": "path", "paths": [[]]}])", "guides[0].paths[0]", "at least one pose"},
        BadGuide{R"([{"kind": "path", "paths": [[[0,0,0,0,0]]]}])", "guides[0].paths[0][0]",
                 "6 numbers"},
        BadGuide{R"([{"kind": "stroke", "paths": [[[0,0,0,0,0,1]]]}])", "guides[0].paths[0][0]",
                 "12 numbers"},
        BadGuide{R"([{"kind": "path", "paths": [[[0,0,0,0,0,0]]]}])", "guides[0].paths[0][0]",
                 "zero"},
        BadGuide{R"([{"kind": "path", "file": "bad.ngc"}])", "guides[0].file", "bad.ngc:1"},
        BadGuide{R"([{"kind": "path", "file": "air.ngc"}])", "guides[0].file", "no cutting motion"},
        BadGuide{R"([{"kind": "stroke", "file": "bad.csv"}])", "guides[0].file", "column \"y\""},
        BadGuide{R"([{"kind": "stroke", "file": "text.csv"}])", "guides[0].file", "line 8"},
        BadGuide{R"([{"kind": "stroke", "file": "else.csv"}])", "guides[0].file", "not loaded"}));

TEST(Guides, MeshStockRequiresASnapSurface) {
  const std::string tetrahedron =
      "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  const SceneSource source{
      .base_folder = {}, .files = {{"t.obj", tetrahedron}}, .load_mesh = load_mesh};
  const std::string stock = R"({"shape": "mesh", "file": "t.obj"})";
  const auto error =
      test::error_of(parse_scene(scene_with(R"([{"kind": "snap"}])", stock), source));
  EXPECT_THAT(error.reason, HasSubstr("surface"));
  const auto given = parse_scene(
      scene_with(R"([{"kind": "snap", "surface": {"shape": "cylinder", "min_mm": [0, 0, 0],
                      "max_mm": [4, 4, 9]}}])",
                 stock),
      source);
  ASSERT_TRUE(given.has_value()) << to_string(given.error());
}

TEST(Guides, NumberOfPosesIsLimited) {
  std::string poses = "[0,0,0,0,0,1]";
  for (std::size_t i = 0; i < kGuidePosesMax; ++i) poses += ",[0,0,0,0,0,1]";
  const auto guides = parse_guides(R"({"guides":[{"kind":"path","paths":[[)" + poses + "]]}]}");
  ASSERT_FALSE(guides.has_value());
  EXPECT_THAT(guides.error(), HasSubstr("the limit is 20000"));
  EXPECT_THAT(parse_guides(R"({"guides":[{"kind":"snap"}]})").error(), HasSubstr("surface"));
  EXPECT_THAT(parse_guides(R"({"guides":[{"kind":"path","file":"a"}]})").error(),
              HasSubstr("may not name a file"));
}

}  // namespace
}  // namespace kerf::guide_test
