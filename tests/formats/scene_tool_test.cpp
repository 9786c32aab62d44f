// SPDX-License-Identifier: Apache-2.0
#include "server/formats/scene.h"
#include "server/formats/tool_text.h"
#include "tests/support/test.h"

namespace kerf::scene_tool_test {
namespace {

using testing::HasSubstr;

std::string scene_with(const std::string& tool) {
  return R"({"stock": {"shape": "box", "min_mm": [0,0,-9], "max_mm": [9,9,0]}, "tools": [{"id": 1, )" +
         tool + "}]}";
}

Scene scene_of(const std::string& tool) {
  auto scene = parse_scene(scene_with(tool), {});
  EXPECT_TRUE(scene.has_value()) << to_string(scene.error());
  return scene.value();
}

const char* const kBullNose =
    R"("shape": "bull_nose", "diameter_mm": 10, "corner_radius_mm": 1, "length_mm": 30)";
const char* const kApt =
    R"("shape": "apt", "d_mm": 10, "r_mm": 1, "e_mm": 4, "f_mm": 1, "alpha_deg": 0, "beta_deg": 0, "h_mm": 30)";
const char* const kLollipop =
    R"("shape": "profile", "profile_mm": [[0,0], {"to": [3,9], "center": [0,5]}, [3,30]])";
const char* const kFormCutter =
    R"("shape": "profile", "profile_mm": [[4,0], [4,2], {"to": [8,6], "radius": 4, "bulge": "in"},
       {"to": [9,7], "radius": 1, "bulge": "out"}, [9,9], [3,9], [3,30]], "chord_tolerance_mm": 0.001)";
const char* const kBody =
    R"(, "shank": {"diameter_mm": 6, "length_mm": 20},
       "holder": [{"diameter_mm": 20, "length_mm": 8}, {"diameter_mm": 30, "top_diameter_mm": 40, "length_mm": 9}])";
const char* const kProfiledHolder =
    R"(, "holder": {"profile_mm": [[10,0], {"to": [12,2], "radius": 2}, [12,30]]})";

TEST(SceneTool, EveryShapeIsRead) {
  EXPECT_EQ(scene_of(kBullNose).tools.at(1).tool, *make_tool(BullNoseShape{10, 1, 30}));
  EXPECT_EQ(scene_of(kApt).tools.at(1).tool, *make_tool(AptShape{10, 1, 4, 1, 0, 0, 30}));
  EXPECT_EQ(scene_of(kLollipop).tools.at(1).tool,
            *make_tool(ProfileShape{{ProfilePoint{0, 0},
                                     ProfileCenteredArc{{3, 9}, {0, 5}, ArcBulge::kOut},
                                     ProfilePoint{3, 30}}}));
  EXPECT_EQ(scene_of(kFormCutter).tools.at(1).tool.radius_mm, 9);
}

std::string filleted(const std::string& accuracy, const std::string& more = "") {
  return R"({"stock": {"shape": "box", "min_mm": [0,0,-9], "max_mm": [9,9,0]}, "accuracy": )" +
         accuracy + R"(, "tools": [{"id": 1, "shape": "profile", "profile_mm":
           [[4,0], [4,2], {"to": [8,6], "radius": 4, "bulge": "in"}, [8,9]])" +
         more +
         R"(, "holder": {"profile_mm": [[9,0], {"to": [12,3], "radius": 3, "bulge": "in"}]}}]})";
}

TEST(SceneTool, FilletsFollowTheTolerance) {
  std::size_t finer = 1000;
  for (const double tolerance : {1e-4, 1e-3, 1e-2, 1e-1}) {
    const auto scene = test::value_of(
        parse_scene(filleted(R"({"tolerance_mm": )" + std::to_string(tolerance) + "}"), {}));
    const SceneTool& tool = scene.tools.at(1);
    const double chord = kChordShare * scene.settings.tolerance_mm;
    EXPECT_EQ(std::get<ProfileShape>(tool.shape).chord_tolerance_mm, chord);
    EXPECT_EQ(std::get<ProfileShape>(*tool.body.holder).chord_tolerance_mm, chord);
    EXPECT_EQ(tool.tool, *make_tool(tool.shape, tool.body));
    // The number of pieces grows as 1 / √tolerance.
    EXPECT_LT(tool.tool.pieces.size(), finer);
    EXPECT_GT(tool.tool.pieces.size(), M_PI / 4 / std::sqrt(2 * chord / 4));
    EXPECT_LT(tool.tool.pieces.size(), M_PI / 4 / std::sqrt(2 * chord / 4) + 4);
    finer = tool.tool.pieces.size();
    // An agent that reads the canonical text gets the same tool.
    const auto again = test::value_of(parse_scene(scene_json(scene), {}));
    EXPECT_EQ(again.tools.at(1).tool, tool.tool);
    EXPECT_FALSE(again.tools.at(1).chords_follow);
  }
}

TEST(SceneTool, FilletsFollowTheToleranceOfATarget) {
  const auto scene = parse_scene(filleted(R"({"target_mm": 0.3})"), {}).value();
  EXPECT_EQ(std::get<ProfileShape>(scene.tools.at(1).shape).chord_tolerance_mm,
            kChordShare * scene.settings.tolerance_mm);
}

TEST(SceneTool, StatedChordToleranceIsKept) {
  auto scene =
      parse_scene(filleted(R"({"tolerance_mm": 0.1})", R"(, "chord_tolerance_mm": 0.002)"), {})
          .value();
  EXPECT_EQ(std::get<ProfileShape>(scene.tools.at(1).shape).chord_tolerance_mm, 0.002);
  // A later change of the tolerance affects the holder only.
  scene.settings.tolerance_mm = 0.5;
  ASSERT_TRUE(resolve_chords(scene).has_value());
  EXPECT_EQ(std::get<ProfileShape>(scene.tools.at(1).shape).chord_tolerance_mm, 0.002);
  EXPECT_EQ(std::get<ProfileShape>(*scene.tools.at(1).body.holder).chord_tolerance_mm, 0.05);
}

TEST(SceneTool, FilletWithTooManyPiecesIsRejectedAtItsPosition) {
  const auto error = test::error_of(parse_scene(
      R"({"stock": {"shape": "box", "min_mm": [0,0,-9], "max_mm": [9,9,0]},
          "accuracy": {"tolerance_mm": 1e-6}, "tools": [{"id": 1, "shape": "profile", "profile_mm":
          [[4,0], {"to": [104,100], "radius": 100, "bulge": "in"}]}]})",
      {}));
  EXPECT_EQ(error.path, "tools[0].profile_mm[1]");
  // The message states the fault, the limit, the remedy, and the source of a value that the tool
  // does not state.
  EXPECT_THAT(error.reason, HasSubstr("1024"));
  EXPECT_THAT(error.reason, HasSubstr("larger chord_tolerance_mm"));
  EXPECT_THAT(error.reason, HasSubstr("(it follows accuracy.tolerance_mm: 0.000001 mm)"));
}

TEST(SceneTool, ShankAndHolderExtendTheCutter) {
  const Tool tool = scene_of(std::string(kBullNose) + kBody).tools.at(1).tool;
  EXPECT_EQ(tool.length_mm, 30);
  EXPECT_EQ(tool.non_cutting,
            (std::vector<ToolPiece>{FrustumPiece{30, 3, 50, 3}, FrustumPiece{50, 10, 58, 10},
                                    FrustumPiece{58, 15, 67, 20}}));
  EXPECT_EQ(scene_of(std::string(kApt) + kProfiledHolder).tools.at(1).tool.whole_length_mm, 60);
}

TEST(SceneTool, CanonicalTextReadsBackEqual) {
  for (const std::string shape : {kBullNose, kApt, kLollipop, kFormCutter}) {
    for (const std::string body : {"", kBody, kProfiledHolder}) {
      const Scene scene = scene_of(shape + body);
      const std::string text = scene_json(scene);
      const auto again = test::value_of(parse_scene(text, {}));
      EXPECT_EQ(scene_json(again), text);
      EXPECT_EQ(again.tools.at(1).tool, scene.tools.at(1).tool);
      std::istringstream lines(explain_scene(scene));
      for (std::string line; std::getline(lines, line);) {
        EXPECT_FALSE(line.ends_with(' ')) << line;  // a field without help
      }
    }
  }
}

/// The engagement from which on the force is steady, 6 √(pitch D), with two digits: 42.4, 134,
/// 189.7.
TEST(SceneTool, ExplanationStatesTheSteadyEngagementInPlainDecimals) {
  for (const auto& [diameter_mm, engagement] :
       {std::pair{"200", "42 mm"}, {"2000", "130 mm"}, {"4000", "190 mm"}}) {
    const Scene scene =
        scene_of(std::string(R"("shape": "flat", "length_mm": 30, "diameter_mm": )") + diameter_mm);
    EXPECT_THAT(explain_scene(scene),
                HasSubstr(std::string("engagement on: tool 1 ") + engagement + ";"));
  }
}

TEST(SceneTool, ToolTextNamesShapeAndDimensions) {
  EXPECT_EQ(tool_text(scene_of(kBullNose).tools.at(1).shape),
            "bull nose, diameter 10 mm, length 30 mm, corner radius 1 mm");
  EXPECT_EQ(tool_text(scene_of(kApt).tools.at(1).shape), "APT cutter 10,1,4,1,0,0,30");
  EXPECT_EQ(tool_text(scene_of(kLollipop).tools.at(1).shape), "profile of 3 points, length 30 mm");
}

struct BadTool {
  const char* tool;
  const char* path;
  const char* reason;
};

class BadTools : public testing::TestWithParam<BadTool> {};

TEST_P(BadTools, AreRejectedWithPathAndReason) {
  const auto error = test::error_of(parse_scene(scene_with(GetParam().tool), {}));
  EXPECT_EQ(error.path, GetParam().path) << error.reason;
  EXPECT_THAT(error.reason, HasSubstr(GetParam().reason));
  EXPECT_GT(error.line, 0u);
}

INSTANTIATE_TEST_SUITE_P(
    SceneTool, BadTools,
    testing::Values(
        BadTool{
            R"("shape": "bull_nose", "diameter_mm": 10, "corner_radius_mm": 6, "length_mm": 30)",
            "tools[0].corner_radius_mm", "half the diameter"},
        BadTool{R"("shape": "bull_nose", "diameter_mm": 10, "length_mm": 30)",
                "tools[0].corner_radius_mm", "missing"},
        BadTool{
            R"("shape": "apt", "d_mm": 10, "r_mm": 1, "e_mm": 2, "f_mm": 1, "alpha_deg": 0, "beta_deg": 0, "h_mm": 30)",
            "tools[0].d_mm", "side line"},
        BadTool{R"("shape": "profile")", "tools[0].profile_mm", "missing"},
        BadTool{R"("shape": "profile", "profile_mm": 3)", "tools[0].profile_mm", "list"},
        BadTool{R"("shape": "profile", "profile_mm": [[3,0]])", "tools[0].profile_mm", "two"},
        BadTool{R"("shape": "profile", "profile_mm": [[3,0], 3])", "tools[0].profile_mm[1]",
                "point"},
        BadTool{R"("shape": "profile", "profile_mm": [[3,0], [3]])", "tools[0].profile_mm[1]",
                "2 numbers"},
        BadTool{R"("shape": "profile", "profile_mm": [[3,0], [3,"5"]])",
                "tools[0].profile_mm[1][1]", "number"},
        BadTool{R"("shape": "profile", "profile_mm": [[3,0], {"to": [3,5]}])",
                "tools[0].profile_mm[1]", "radius or center"},
        BadTool{R"("shape": "profile", "profile_mm": [[3,0], {"to": [3,5], "radius": 1}])",
                "tools[0].profile_mm[1].radius", "half the distance"},
        BadTool{
            R"("shape": "profile", "profile_mm": [[3,0], {"to": [3,5], "radius": 3, "bulge": "up"}])",
            "tools[0].profile_mm[1].bulge", "up"},
        BadTool{
            R"("shape": "profile", "profile_mm": [[3,0], {"to": [3,5], "radius": 3, "size": 1}])",
            "tools[0].profile_mm[1].size", "not a field"},
        BadTool{R"("shape": "profile", "profile_mm": [[3,0], [3,5], [3,4]])",
                "tools[0].profile_mm[2]", "lower"},
        BadTool{R"("shape": "profile", "profile_mm": [[3,0], [3,5]], "chord_tolerance_mm": 0)",
                "tools[0].chord_tolerance_mm", "above 0"},
        BadTool{R"("shape": "flat", "diameter_mm": 9, "length_mm": 9, "shank": 3)",
                "tools[0].shank", "object"},
        BadTool{R"("shape": "flat", "diameter_mm": 9, "length_mm": 9, "shank": {"diameter_mm": 3})",
                "tools[0].shank.length_mm", "missing"},
        BadTool{R"("shape": "flat", "diameter_mm": 9, "length_mm": 9, "holder": 3)",
                "tools[0].holder", "sections"},
        BadTool{
            R"("shape": "flat", "diameter_mm": 9, "length_mm": 9, "holder": [{"diameter_mm": 1e5, "length_mm": 1}])",
            "tools[0].holder[0].diameter_mm", "5000"},
        BadTool{
            R"("shape": "flat", "diameter_mm": 9, "length_mm": 9, "holder": {"profile_mm": [[3,1],[3,2]]})",
            "tools[0].holder.profile_mm[0]", "height 0"}));

TEST(SceneTool, MutatedProfilesAreReadOrRejected) {
  std::mt19937_64 random(3);
  const std::string whole = scene_with(kFormCutter);
  const std::string bits = "[]{},:\"0-9.eE";
  int read = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text = whole;
    for (std::size_t k = 1 + random() % 3; k > 0; --k) {
      const std::size_t at = whole.find("profile_mm") + random() % 140;
      switch (random() % 3) {
        case 0:
          text.erase(at, 1);
          break;
        case 1:
          text.insert(at, 1, bits[random() % bits.size()]);
          break;
        default:
          text[at] = bits[random() % bits.size()];
      }
    }
    const auto scene = parse_scene(text, {});
    if (scene) {
      ++read;
    } else {
      ASSERT_FALSE(scene.error().reason.empty()) << text;
    }
  }
  EXPECT_GT(read, 100);
}

}  // namespace
}  // namespace kerf::scene_tool_test
