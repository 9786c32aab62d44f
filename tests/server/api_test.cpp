// SPDX-License-Identifier: Apache-2.0
// Requests to the whole interface, without sockets.
#include "server/http/api.h"

#include <nlohmann/json.hpp>

#include "server/http/routes.h"
#include "server/matters.h"
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"
#include "tests/support/zip_files.h"

namespace kerf::net::api_test {
namespace {

class ApiTest : public SessionTest {
 protected:
  void SetUp() override {
    matters = net::matters();
    SessionTest::SetUp();
    options.data_folder = folder.path();
    access = *Access::open({});
    api.emplace(options, *registry, metrics, *access, http_matters());
  }
  ApiResponse ask(const std::string& method, std::string_view target, std::string body = {}) {
    ApiRequest request = *parse_target(target);
    request.method = method;
    request.body = std::move(body);
    return api->handle(request);
  }
  RouteMatch match(std::string_view method, std::string_view target) const {
    return api->routes().match(method, parse_target(target)->path);
  }
  static std::string code(const ApiResponse& response) {
    return nlohmann::json::parse(response.body).at("error").at("code");
  }
  static std::string header(const ApiResponse& response, std::string_view name) {
    for (const auto& [key, value] : response.headers) {
      if (key == name) return value;
    }
    return "";
  }

  HttpOptions options;
  Metrics metrics;
  std::unique_ptr<Access> access;
  std::optional<Api> api;
};

constexpr const char* kTetrahedron =
    "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

TEST_F(ApiTest, MeshUploadNeedsMemoryForReading) {
  const std::string body = kTetrahedron;
  options.program_bytes = 19 * body.size();
  api.emplace(options, *registry, metrics, *access, http_matters());
  const ApiResponse busy = ask("POST", "/v1/files?name=a.obj", body);
  EXPECT_EQ(busy.status, 503U) << busy.body;
  EXPECT_FALSE(header(busy, "Retry-After").empty());
  options.program_bytes = 20 * body.size();
  api.emplace(options, *registry, metrics, *access, http_matters());
  for (int n = 0; n < 3; ++n) {  // the memory is returned
    EXPECT_EQ(ask("POST", "/v1/files?name=a.obj", body).status, 201U);
  }
}

TEST_F(ApiTest, ExpansionOfUploadedMeshesIsLimited) {
  // Object n contains object n - 1 twice, and object 1 is a triangle: 2^20 triangles.
  std::string objects =
      R"(<object id="1"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>)"
      R"(<vertex x="0" y="1" z="0"/></vertices><triangles><triangle v1="0" v2="1" v3="2"/>)"
      "</triangles></mesh></object>";
  for (int n = 2; n <= 21; ++n) {
    const std::string half = "<component objectid=\"" + std::to_string(n - 1) + "\"/>";
    objects += "<object id=\"" + std::to_string(n) + "\"><components>" + half + half +
               "</components></object>";
  }
  const std::string model =
      R"(<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>)" +
      objects + R"(</resources><build><item objectid="21"/></build></model>)";
  const ApiResponse response =
      ask("POST", "/v1/files?name=a.3mf", test::zip_of({{"3D/3dmodel.model", model}}));
  EXPECT_EQ(code(response), "too_large") << response.body;
}

TEST_F(ApiTest, UnknownPathsAreNotFound) {
  for (const char* target : {"/v1", "/v1/x", "/nothing"}) {
    const ApiResponse response = ask("GET", target);
    EXPECT_EQ(response.status, 404U) << target;
    EXPECT_EQ(code(response), "not_found") << target;
  }
  EXPECT_EQ(code(ask("GET", "/v1/sessions/demo")), "unknown_session");
  EXPECT_EQ(code(ask("GET", "/v1/sessions/demo/x")), "unknown_session");
}

// The executor of this session runs nothing, so a request that waits for it never returns.
TEST_F(ApiTest, ListsAndHealthDoNotWaitForASession) {
  const auto session = start();
  move(*session, join(*session), 0, 0, -1);
  for (const Route& route : api->routes().all()) {
    if (route.runs != Runs::kAtOnce || route.upgrade != Upgrade::kNone) continue;
    std::string target(route.pattern);
    if (const auto id = target.find("{id}"); id != target.npos) target.replace(id, 4, "block");
    EXPECT_NE(ask("GET", target).status, 500U) << target;
  }
  const auto list = nlohmann::json::parse(ask("GET", "/v1/sessions").body).at("sessions");
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].at("id"), "block");
  EXPECT_EQ(list[0].at("participants"), 1U);
  EXPECT_EQ(match("GET", "/healthz").route->runs, Runs::kAtOnce);
  EXPECT_EQ(match("GET", "/v1/sessions").route->runs, Runs::kAtOnce);
  EXPECT_EQ(match("GET", "/v1/sessions/block/model.stl").route->runs, Runs::kExport);
  EXPECT_EQ(executor->waiting(), 0U);
}

TEST_F(ApiTest, OtherMethodsAreNotAllowed) {
  const auto session = start();
  for (const Route& route : api->routes().all()) {
    if (route.upgrade != Upgrade::kNone) continue;
    std::string target(route.pattern);
    if (const auto id = target.find("{id}"); id != target.npos) target.replace(id, 4, "block");
    for (auto open = target.find('{'); open != target.npos; open = target.find('{')) {
      target.replace(open, target.find('}') - open + 1, "x");
    }
    const ApiResponse response = ask("PUT", target);
    EXPECT_EQ(response.status, 405U) << target;
    EXPECT_EQ(code(response), "bad_method") << target;
    EXPECT_TRUE(header(response, "Allow").contains(route.methods)) << target;
    EXPECT_TRUE(response.body.contains("method PUT is not allowed"));
  }
}

TEST_F(ApiTest, WebSocketEndpointsRequireAnUpgrade) {
  const auto session = start();
  for (const char* target : {"/v1/sessions/block/agent", "/v1/sessions/block/view"}) {
    const ApiResponse response = ask("GET", target);
    EXPECT_EQ(response.status, 426U) << target;
    EXPECT_EQ(header(response, "Upgrade"), "websocket");
  }
}

TEST_F(ApiTest, InvalidDownloadParametersAreNamed) {
  const auto session = start();
  const std::pair<const char*, const char*> cases[] = {
      {"model.stl?triangles=0", "triangles must be an integer > 0"},
      {"model.stl?triangles=-3", "triangles must be an integer > 0"},
      {"model.stl?error_mm=none", "error_mm must be a number >= 0"},
      {"model.stl?shift_mm=1,2", "shift_mm must be three numbers X,Y,Z"},
      {"model.glb?encoding=zip", "encoding must be one of: "},
      {"program.ngc?post=mazak", "post must be one of linuxcnc, grbl, fanuc, haas, heidenhain"},
      {"program.ngc?from=a", "from and to must be journal record numbers"},
      {"program.apt?tolerance_mm=-1", "tolerance_mm must be a number >= 0"},
      {"forces.csv?participant=Ada", "participant must be a participant number"},
      {"forces.csv?device_limits=6", "device_limits must be two numbers > 0"},
      {"forces.csv?device_limits=6,nan", "device_limits must be two numbers > 0"},
      {"forces.csv?device_limits=6,150,1", "device_limits must be two numbers > 0"}};
  for (const auto& [target, reason] : cases) {
    const ApiResponse response = ask("GET", std::string("/v1/sessions/block/") + target);
    EXPECT_EQ(response.status, 400U) << target;
    EXPECT_TRUE(response.body.contains(reason)) << response.body;
  }
  EXPECT_EQ(ask("GET", "/v1/sessions/block/model.xyz").status, 404U);
}

TEST_F(ApiTest, DryRunReturnsTheCostAndCreatesNothing) {
  using nlohmann::json;
  json scene = json::parse(kScene);
  const auto price = [&](double pitch_mm) {
    scene["accuracy"]["pitch_mm"] = pitch_mm;
    const ApiResponse response = ask("POST", "/v1/sessions?dry_run=1", scene.dump());
    EXPECT_EQ(response.status, 200U) << response.body;
    return json::parse(response.body);
  };
  const json coarse = price(0.5), fine = price(0.25);
  EXPECT_EQ(coarse["columns"], json({80, 80}));
  EXPECT_EQ(fine["columns"], json({160, 160}));
  EXPECT_GT(coarse["bytes"], 6400 * 8) << "two ends of each column";
  EXPECT_GT(fine["bytes"], 25'600 * 8);
  EXPECT_GT(coarse["join_s"], 0);
  EXPECT_NEAR(fine["join_s"].get<double>() / coarse["join_s"].get<double>(), 4, 1e-9);
  EXPECT_GT(coarse["us_per_motion"], 0);
  EXPECT_NEAR(coarse["predicted_error_mm"].get<double>(), 0.9 * 0.5 + 0.01, 1e-12);
  EXPECT_EQ(coarse["accuracy"]["pitch_mm"], 0.5);
  EXPECT_EQ(coarse["tools"].size(), 2U);
  scene["accuracy"]["pitch_mm"] = 0;
  const ApiResponse bad = ask("POST", "/v1/sessions?dry_run=1", scene.dump());
  EXPECT_EQ(bad.status, 400U);
  EXPECT_EQ(code(bad), "bad_scene");
  EXPECT_TRUE(registry->list().empty());
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "test-block.kerf"));
}

TEST_F(ApiTest, ProgramIsPricedInASceneWithoutASession) {
  using nlohmann::json;
  const auto program = [](int rows) {
    std::string text = "G21 G90 F600\nT1 M6\nG0 X0 Y0 Z5\n";
    for (int row = 0; row < rows; ++row) {
      const std::string y = std::to_string(row);
      text += "G0 X-15 Y" + y + "\nG1 Z-1\nG1 X15\nG0 Z5\n";
    }
    return text + "M30\n";
  };
  const auto ask_price = [&](const json& body) {
    return ask("POST", "/v1/prices?name=a.ngc", body.dump());
  };
  const json scene = json::parse(kScene);
  const auto price = [&](int rows) {
    const ApiResponse response = ask_price({{"scene", scene}, {"program", program(rows)}});
    EXPECT_EQ(response.status, 200U) << response.body;
    return json::parse(response.body);
  };
  const json one = price(1), many = price(15);
  EXPECT_GT(many["motions"], 10 * one["motions"].get<int>());
  EXPECT_GE(many["bytes"], one["bytes"]) << "fifteen rows reach more tiles";
  EXPECT_GT(many["us_per_motion"], 0);
  EXPECT_EQ(one["accuracy"]["pitch_mm"], 0.5);
  EXPECT_EQ(code(ask_price({{"scene", scene}})), "bad_request");
  EXPECT_EQ(code(ask("POST", "/v1/prices", "{")), "bad_request");
  EXPECT_EQ(code(ask_price({{"scene", json::object()}, {"program", ""}})), "bad_scene");
  EXPECT_EQ(code(ask_price({{"scene", scene}, {"program", "G1 X\n"}})), "bad_program");
  EXPECT_TRUE(registry->list().empty());
}

TEST_F(ApiTest, ASceneIsDerivedForAProgramWithoutASession) {
  using nlohmann::json;
  const ApiResponse response =
      ask("POST", "/v1/programs?name=a.ngc",
          "(T4 6MM BALL ENDMILL)\nG21 G90\nT4 M6\nG0 X1 Y2 Z5\nG1 Z-3 F60\nG1 X9\nM30\n");
  ASSERT_EQ(response.status, 200U) << response.body;
  const json derived = json::parse(response.body);
  const json& scene = derived.at("scene");
  EXPECT_EQ(scene.at("machine").at("kinematics"), "xyz");
  ASSERT_EQ(scene.at("tools").size(), 1U);
  EXPECT_EQ(scene.at("tools").at(0).at("shape"), "ball");
  EXPECT_EQ(scene.at("stock").at("min_mm"), json({-2, -1, -5}));
  EXPECT_EQ(derived.at("motions"), 2);
  EXPECT_GT(derived.at("machine_s"), derived.at("programmed_s"));
  const json& origins = derived.at("provenance");
  const auto diameter = std::ranges::find_if(
      origins, [](const json& one) { return one.at("field") == "diameter_mm"; });
  ASSERT_NE(diameter, origins.end());
  EXPECT_EQ(*diameter, json({{"tool", 4},
                             {"field", "diameter_mm"},
                             {"origin", "stated"},
                             {"source", "comment in line 1"}}));
  EXPECT_EQ(ask("POST", "/v1/sessions?id=derived", scene.dump()).status, 201U);
  const ApiResponse bad = ask("POST", "/v1/programs?name=a.ngc", "G21\nG1 X\n");
  EXPECT_EQ(bad.status, 400U);
  EXPECT_EQ(code(bad), "bad_program");
  EXPECT_EQ(json::parse(bad.body).at("error").at("line"), 2);
  EXPECT_EQ(code(ask("POST", "/v1/programs?name=a/b.ngc", "")), "bad_name");
  const ApiResponse air = ask("POST", "/v1/programs", "M30\n");
  EXPECT_EQ(code(air), "bad_program");
  EXPECT_NE(air.body.find("cuts nothing"), std::string::npos);
}

TEST_F(ApiTest, DryRunFailsLikeCreation) {
  const auto fails = [&](const std::string& query, unsigned status, const std::string& error) {
    for (const char* dry : {"&dry_run=1", ""}) {
      const ApiResponse response = ask("POST", "/v1/sessions?" + query + dry, kScene);
      EXPECT_EQ(response.status, status) << query << dry << response.body;
      EXPECT_EQ(code(response), error) << query << dry;
    }
  };
  const auto renew = [&](std::size_t sessions, std::uintmax_t bytes) {
    registry.emplace(
        RegistryOptions{folder.path(), sessions, limits, {}, snapshots, {.folder = bytes}},
        [this](const std::string&) { return executor; }, workers);
    api.emplace(options, *registry, metrics, *access, http_matters());
  };
  renew(1, 0);
  for (int n = 0; n < 2; ++n) {
    EXPECT_EQ(ask("POST", "/v1/sessions?id=one&dry_run=1", kScene).status, 200U);
  }
  EXPECT_EQ(ask("POST", "/v1/sessions?id=one", kScene).status, 201U);
  fails("id=two", 503, "too_many_sessions");
  renew(4, 0);
  fails("id=one", 409, "session_exists");
  renew(4, 1);
  fails("id=two", 507, "disk_full");
}

TEST_F(ApiTest, EachTemplateCanBePricedAndCreated) {
  const auto list = nlohmann::json::parse(ask("GET", "/v1/templates").body).at("templates");
  ASSERT_GE(list.size(), 4U);
  registry.emplace(
      RegistryOptions{folder.path(), 20, limits, {}, snapshots},
      [this](const std::string&) { return executor; }, workers);
  api.emplace(options, *registry, metrics, *access, http_matters());
  for (const auto& one : list) {
    const std::string scene = one.at("scene").dump();
    EXPECT_EQ(ask("POST", "/v1/sessions?dry_run=1", scene).status, 200U) << one.at("id");
    EXPECT_EQ(ask("POST", "/v1/sessions", scene).status, 201U) << one.at("id");
  }
  EXPECT_EQ(registry->list().size(), list.size());
}

TEST_F(ApiTest, AListOfSessionsStatesWhenTheyWereCreatedAndUsed) {
  const auto now_ms = [] {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
  };
  const auto listed = [&] {
    return nlohmann::json::parse(ask("GET", "/v1/sessions").body).at("sessions").at(0);
  };
  const auto before_ms = now_ms() - 100;  // records are stamped to some 10 ms
  const auto session = start();
  const auto created = listed();
  EXPECT_EQ(created.at("name"), "Test block");
  EXPECT_GE(created.at("created_ms"), before_ms);
  EXPECT_LE(created.at("created_ms"), now_ms());
  const auto ada = join(*session);
  move(*session, ada, 0, 0, -1);
  move(*session, ada, 1, 0, -1);
  const auto used = listed();
  EXPECT_EQ(used.at("created_ms"), created.at("created_ms"));
  EXPECT_GE(used.at("active_ms"), created.at("active_ms"));
  ASSERT_TRUE(session->flush());
  const auto active_ms = used.at("active_ms").get<std::int64_t>();
  restart();
  registry->load_all();
  api.emplace(options, *registry, metrics, *access, http_matters());
  EXPECT_EQ(listed().at("created_ms"), created.at("created_ms"));
  EXPECT_NEAR(listed().at("active_ms").get<double>(), static_cast<double>(active_ms), 100);
}

}  // namespace
}  // namespace kerf::net::api_test
