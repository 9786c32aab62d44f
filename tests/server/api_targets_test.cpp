// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "server/targets/target_parts.h"
#include "tests/server/api_rights_fixture.h"

namespace kerf::net::api_targets_test {
namespace {

const std::string kTargets = "/v1/sessions/block/targets";

/// A box as ASCII STL, counter-clockwise seen from outside, without its last `missing` facets.
std::string box_stl(Vec3 low, Vec3 high, std::size_t missing = 0) {
  constexpr std::array<std::array<int, 3>, 12> kFacets{{{0, 2, 1},
                                                        {1, 2, 3},
                                                        {4, 5, 6},
                                                        {5, 7, 6},
                                                        {0, 1, 4},
                                                        {1, 5, 4},
                                                        {2, 6, 3},
                                                        {3, 6, 7},
                                                        {0, 4, 2},
                                                        {2, 4, 6},
                                                        {1, 3, 5},
                                                        {3, 7, 5}}};
  std::string text = "solid box\n";
  for (std::size_t n = 0; n + missing < kFacets.size(); ++n) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int corner : kFacets.at(n)) {
      text += "vertex " + std::to_string((corner & 1) != 0 ? high.x : low.x) + " " +
              std::to_string((corner & 2) != 0 ? high.y : low.y) + " " +
              std::to_string((corner & 4) != 0 ? high.z : low.z) + "\n";
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid box\n";
}

/// The stock of the session is 40 x 40 x 20, from -20 to 20 and from -20 to 0.
class ApiTargetsTest : public ApiRightsTest {
 protected:
  ApiResponse send(const std::string& query, const std::string& body, Role role = Role::kSculptor) {
    ApiRequest request = *parse_target(kTargets + query);
    request.method = "POST";
    request.token = tokens[role];
    request.body = body;
    return api->handle(request);
  }
  std::string code_of(const ApiResponse& response) {
    return Json::parse(response.body).at("error").at("code");
  }
  std::vector<float> distances(const std::vector<float>& points) {
    std::string body(points.size() * sizeof(float), '\0');
    std::memcpy(body.data(), points.data(), body.size());
    const ApiResponse response = send("/part.stl/distances", body, Role::kWatcher);
    EXPECT_EQ(response.status, 200U) << response.body;
    std::vector<float> values(response.body.size() / sizeof(float));
    std::memcpy(values.data(), response.body.data(), response.body.size());
    return values;
  }
  Json survey(const ApiResponse& response) {
    std::string text(response.file->bytes(), '\0');
    response.file->read(0, text.data(), text.size());
    return Json::parse(text);
  }

  const std::string part_ = box_stl({-20, -20, -20}, {20, 20, -0.5});
};

TEST_F(ApiTargetsTest, DoubtfulUnitsRaiseAQuestion) {
  const std::string metres = box_stl({-0.02, -0.02, -0.02}, {0.02, 0.02, 0});
  const Json asked = Json::parse(send("?name=part.stl", metres).body);
  const Json& choices = asked.at("questions").at(0).at("choices");
  EXPECT_EQ(asked.at("questions").at(0).at("field"), "unit");
  EXPECT_EQ(choices.at(2).at("unit"), "m");
  EXPECT_NEAR(choices.at(2).at("size_mm"), 40, 1e-9);
  const Json answered = Json::parse(send("?name=part.stl&unit=m&shift_mm=1,0,0", metres).body);
  EXPECT_FALSE(answered.contains("questions"));
  EXPECT_NEAR(answered.at("max_mm").at(0), 21, 1e-6);
  // The unit is stored with the file.
  api.reset();
  open(kAdmin, false);
  EXPECT_NEAR(distances({1, 0, 1}).at(0), 1, 1e-5);
  EXPECT_EQ(code_of(send("?name=part.stl&unit=mile", metres)), "bad_unit");
}

TEST_F(ApiTargetsTest, PartAThousandTimesItsBlockIsScaled) {
  const std::string huge = box_stl({-20'000, -20'000, -20'000}, {20'000, 20'000, 0});
  const Json asked = Json::parse(send("?name=part.stl", huge).body);
  const Json& choice = asked.at("questions").at(0).at("choices").at(0);
  EXPECT_NEAR(choice.at("size_mm"), 40, 1e-9);
  const std::string scale = "&scale=" + choice.at("scale").dump();
  const Json answered = Json::parse(send("?name=part.stl" + scale, huge).body);
  EXPECT_FALSE(answered.contains("questions"));
  EXPECT_NEAR(answered.at("max_mm").at(0), 20, 1e-6);
  for (const char* bad : {"0", "-1", "nan", "1e7", "x"})
    EXPECT_EQ(code_of(send("?name=part.stl&scale=" + std::string(bad), huge)), "bad_value") << bad;
}

TEST_F(ApiTargetsTest, DownloadedModelCanBeUploadedAsATarget) {
  for (const std::string file : {"model.stl", "model.obj?shift_mm=100,0,0", "model.ply?error_mm=0",
                                 "model.stl?encoding=ascii&error_mm=0.1"}) {
    const ApiResponse model = ask("GET", "/v1/sessions/block/" + file, tokens[Role::kWatcher]);
    ASSERT_EQ(model.status, 200U) << model.body;
    std::string bytes(model.file->bytes(), '\0');
    model.file->read(0, bytes.data(), bytes.size());
    const auto header = std::ranges::find(model.headers, "Kerf-Model",
                                          [](const auto& h) { return std::string(h.first); });
    ASSERT_NE(header, model.headers.end());
    const Json note = Json::parse(header->second);
    const std::string name = "part" + file.substr(5, 4);
    const Json part = Json::parse(send("?name=" + name, bytes).body);
    EXPECT_EQ(part.at("triangles"), note.at("triangles")) << file;
    EXPECT_FALSE(part.contains("fault")) << part;
    const double shift = file.find("shift_mm") == file.npos ? 0 : 100;
    EXPECT_EQ(part.at("min_mm"), Json({-20 + shift, -20, -20}));
    EXPECT_EQ(note.contains("within_mm"), file.ends_with("0.1"));
    EXPECT_FALSE(note.contains("warning"));
  }
}

TEST_F(ApiTargetsTest, FarShiftedModelReportsCollapsedTriangles) {
  const ApiResponse model =
      ask("GET", "/v1/sessions/block/model.stl?shift_mm=990000,0,0", tokens[Role::kWatcher]);
  ASSERT_EQ(model.status, 200U);
  for (const auto& [name, value] : model.headers) {
    if (name != std::string("Kerf-Model")) continue;
    const std::string text = Json::parse(value).at("warning");
    EXPECT_NE(text.find("shift_mm=20,20,20 moves"), text.npos) << text;
    return;
  }
  FAIL() << "no header";
}

TEST_F(ApiTargetsTest, SculptorsSetAndRemoveTargetsForWatchers) {
  Json set = Json::parse(send("?name=part.stl&shift_mm=1,0,0", part_).body);
  EXPECT_EQ(set.at("name"), "part.stl");
  EXPECT_EQ(set.at("triangles"), 12);
  EXPECT_EQ(set.at("min_mm"), Json({-19, -20, -20}));
  EXPECT_EQ(set.at("max_mm"), Json({21, 20, -0.5}));
  EXPECT_FALSE(set.contains("fault"));
  EXPECT_EQ(send("?name=part.stl", part_, Role::kWatcher).status, 403U);
  EXPECT_EQ(made("GET", kTargets, tokens[Role::kSculptor]).at("targets"), Json::array({set}));
  set["may_change"] = false;
  EXPECT_EQ(made("GET", kTargets, tokens[Role::kWatcher]).at("targets"), Json::array({set}));
  made("DELETE", kTargets + "/part.stl", tokens[Role::kWatcher], 403);
  made("DELETE", kTargets + "/part.stl", tokens[Role::kSculptor]);
  EXPECT_EQ(
      made("DELETE", kTargets + "/part.stl", tokens[Role::kSculptor], 404).at("error").at("code"),
      "unknown_target");
  EXPECT_TRUE(made("GET", kTargets, tokens[Role::kWatcher]).at("targets").empty());
}

TEST_F(ApiTargetsTest, AreLimitedInNumberAndReplacedByName) {
  for (std::size_t n = 0; n < TargetParts::kPartsOfSession; ++n) {
    EXPECT_EQ(send("?name=" + std::to_string(n) + ".stl", part_).status, 201U);
  }
  EXPECT_EQ(code_of(send("?name=one%20more.stl", part_)), "limit");
  EXPECT_EQ(send("?name=3.stl", box_stl({0, 0, 0}, {1, 1, 1})).status, 201U);
  const Json list = made("GET", kTargets, tokens[Role::kWatcher]).at("targets");
  ASSERT_EQ(list.size(), TargetParts::kPartsOfSession);
  EXPECT_EQ(list[3].at("max_mm"), Json({1, 1, 1}));
}

TEST_F(ApiTargetsTest, RejectMalformedFilesAndNames) {
  EXPECT_EQ(code_of(send("", part_)), "bad_name");
  EXPECT_EQ(code_of(send("?name=part.step", part_)), "bad_name");
  EXPECT_EQ(code_of(send("?name=" + std::string(65, 'x') + ".stl", part_)), "bad_name");
  EXPECT_EQ(code_of(send("?name=part.stl&shift_mm=1,2", part_)), "bad_place");
  EXPECT_EQ(code_of(send("?name=part.stl", "solid x\nendsolid x\n")), "empty");
  // A name is not a path.
  EXPECT_EQ(send("?name=..%2F..%2Fpart.stl", part_).status, 201U);
  EXPECT_EQ(made("GET", kTargets, tokens[Role::kWatcher]).at("targets")[0].at("name"),
            "../../part.stl");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "part.stl"));
}

TEST_F(ApiTargetsTest, ReportOpenMeshes) {
  const Json set = Json::parse(send("?name=open.stl", box_stl({0, 0, 0}, {1, 1, 1}, 1)).body);
  EXPECT_NE(set.at("fault"), "");
}

TEST_F(ApiTargetsTest, DistancesAreSignedAndExact) {
  send("?name=part.stl", part_);
  // On top of the stock, inside the part, next to its upper edge, and beyond a corner.
  const auto values = distances({0, 0, 0, 0, 0, -2.5F, 23, 0, 3.5F, 23, 24, -20});
  ASSERT_EQ(values.size(), 4U);
  EXPECT_FLOAT_EQ(values[0], 0.5F);
  EXPECT_FLOAT_EQ(values[1], -2);
  EXPECT_FLOAT_EQ(values[2], 5);
  EXPECT_FLOAT_EQ(values[3], 5);
}

TEST_F(ApiTargetsTest, DistancesNeedPoints) {
  send("?name=part.stl", part_);
  const auto code = [&](const std::string& body) {
    return code_of(send("/part.stl/distances", body, Role::kWatcher));
  };
  EXPECT_EQ(code(""), "bad_points");
  EXPECT_EQ(code(std::string(13, '\0')), "bad_points");
  EXPECT_EQ(code(std::string(12, '\xff')), "bad_points");  // NaN
  EXPECT_EQ(code_of(send("/other.stl/distances", std::string(12, '\0'))), "unknown_target");
}

TEST_F(ApiTargetsTest, DeviationIsMeasuredAtAPointInTime) {
  send("?name=part.stl", part_);
  const std::string deviation = kTargets + "/part.stl/deviation";
  const ApiResponse response = ask("GET", deviation, tokens[Role::kWatcher]);
  ASSERT_EQ(response.status, 200U) << response.body;
  const Json now = survey(response);
  EXPECT_EQ(now.at("target"), "part.stl");
  EXPECT_NEAR(now.at("greatest_mm").get<double>(), 0.5, 1e-6);
  EXPECT_NEAR(now.at("least_mm").get<double>(), 0, 1e-6);
  EXPECT_NEAR(now.at("area_mm2").get<double>(), 2 * 1600 + 160 * 20, 1e-3);
  EXPECT_EQ(now.at("quantiles_mm").size(), 1001U);
  ASSERT_FALSE(now.at("worst").empty());
  EXPECT_NEAR(now.at("worst")[0].at("mm").get<double>(), 0.5, 1e-6);
  EXPECT_EQ(now.at("state_hash"),
            made("GET", "/v1/sessions/block", tokens[Role::kWatcher]).at("state_hash"));
  EXPECT_EQ(survey(ask("GET", deviation + "?at=0", tokens[Role::kWatcher])).at("record"), 0);
  made("GET", deviation + "?at=99", tokens[Role::kWatcher], 404);
  made("GET", kTargets + "/x.stl/deviation", tokens[Role::kWatcher], 404);
  ApiRequest again = *parse_target(deviation);
  again.method = "GET";
  again.token = tokens[Role::kWatcher];
  for (const auto& [name, value] : response.headers)
    if (name == "ETag") again.if_none_match = value;
  EXPECT_EQ(api->handle(again).status, 304U);
  again.if_none_match = "*";  // matches any file of the client
  EXPECT_EQ(api->handle(again).status, 304U);
  again.if_none_match = "\"other\"";
  EXPECT_EQ(api->handle(again).status, 200U);
  ApiRequest missing = *parse_target(kTargets + "/x.stl/deviation");
  missing.method = "GET";
  missing.token = tokens[Role::kWatcher];
  missing.if_none_match = "*";
  EXPECT_EQ(api->handle(missing).status, 404U);
}

TEST_F(ApiTargetsTest, SurviveARestartAndEndWithTheSession) {
  send("?name=part.stl&shift_mm=0,0,0.5", part_);
  open(kAdmin, false);  // as after a restart
  EXPECT_EQ(made("GET", kTargets, tokens[Role::kWatcher]).at("targets").size(), 1U);
  EXPECT_FLOAT_EQ(distances({0, 0, 2})[0], 2);
  made("DELETE", "/v1/sessions/block?purge=1", tokens[Role::kOwner]);
  session.reset();
  session = *registry->create("block", kScene, SceneSource{});
  open(kAdmin, false);
  EXPECT_TRUE(made("GET", kTargets, tokens[Role::kWatcher]).at("targets").empty());
}

/// Runs a program to its end.
class ProgramTargets : public ApiTargetsTest {
 protected:
  ApiResponse start(const std::string& query, const std::string& text) {
    ApiRequest request = *parse_target("/v1/sessions/block/programs?name=a.ngc" + query);
    request.method = "POST";
    request.token = tokens[Role::kSculptor];
    request.body = text;
    return api->handle(request);
  }
  Json status_of(const ApiResponse& started) {
    EXPECT_EQ(started.status, 202U) << started.body;
    const Json json =
        made("GET", std::string(Json::parse(started.body).at("url")), tokens[Role::kWatcher]);
    EXPECT_EQ(json.at("state"), "finished") << json;
    return json;
  }
  /// The part begins 0.5 mm below the top of the stock.
  static std::string deep(const std::string& y = "0") {
    return "G21 G90 T1 M6\n"
           "G0 X-30 Y" +
           y +
           " Z-0.5\n"
           "G1 X-10 F900\n"  // line 3: down to the part
           "G1 X10 Z-1.5\n"  // line 4: into it, ever deeper
           "G0 Z9\n"
           "M2\n";
  }
};

TEST_F(ProgramTargets, CutsBelowThePartAreAlarmsWithLineAndPlace) {
  ASSERT_EQ(send("?name=part.stl", part_).status, 201U);
  for (const std::string y : {"-10", "10"}) {
    const std::string sampled = y == "10" ? "&sample_hz=50" : "";
    const Json json =
        status_of(start("&target=part.stl&target_tolerance_mm=0.2&pace=fast" + sampled, deep(y)));
    EXPECT_EQ(json.at("target"), "part.stl");
    EXPECT_EQ(json.at("target_tolerance_mm"), 0.2);
    ASSERT_EQ(json.at("alarm_count"), 1) << json;
    const Json alarm = json.at("alarms").at(0);
    EXPECT_EQ(alarm.at("kind"), "gouge");
    EXPECT_EQ(alarm.at("unit"), "mm");
    EXPECT_EQ(alarm.at("from_line"), 4);
    EXPECT_NEAR(alarm.at("amount"), 1, 0.02);
    EXPECT_NEAR(alarm.at("at_mm").at(2), -1.5, 0.02);
    EXPECT_NEAR(alarm.at("at_mm").at(1), std::stod(y), 0.5);
  }
}

TEST_F(ProgramTargets, NothingIsSearchedWithoutATarget) {
  send("?name=part.stl", part_);
  const Json json = status_of(start("&pace=fast", deep()));
  EXPECT_FALSE(json.contains("target"));
  EXPECT_EQ(json.at("alarm_count"), 0);
}

TEST_F(ProgramTargets, WithinTheToleranceThereIsNoAlarm) {
  send("?name=part.stl", part_);
  const Json json = status_of(start("&target=part.stl&target_tolerance_mm=1.2&pace=fast", deep()));
  EXPECT_EQ(json.at("alarm_count"), 0);
}

TEST_F(ProgramTargets, NeedAPartOfTheSessionAndAPositiveTolerance) {
  send("?name=part.stl", part_);
  EXPECT_EQ(code_of(start("&target=other.stl", deep())), "unknown_target");
  EXPECT_EQ(code_of(start("&target=part.stl&target_tolerance_mm=0", deep())), "bad_value");
}

}  // namespace
}  // namespace kerf::net::api_targets_test
