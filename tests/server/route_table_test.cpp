// SPDX-License-Identifier: Apache-2.0
#include "server/http/routes.h"
#include "server/matters.h"
#include "tests/support/test.h"

namespace kerf::net::route_table_test {
namespace {

const RouteTable& table() {
  static const RouteTable kTable(http_matters());
  return kTable;
}

RouteMatch match(std::string_view method, std::string_view target) {
  return table().match(method, parse_target(target)->path);
}

TEST(Routes, MethodAndPathSelectARow) {
  const RouteMatch found = match("POST", "/v1/sessions/demo/programs");
  ASSERT_NE(found.route, nullptr);
  EXPECT_EQ(found.route->runs, Runs::kRead);
  EXPECT_EQ(found.allow, "GET, HEAD, POST");
  EXPECT_EQ(match("DELETE", "/v1/sessions/demo/programs/7").captured, "7");
  EXPECT_EQ(match("GET", "/v1/sessions/demo/model.glb").captured, "glb");
  EXPECT_EQ(match("GET", "/v1/sessions/demo/view").upgrade, Upgrade::kViewer);
}

// Requests that parse foreign bytes, make files or look back may take long.
TEST(Routes, ShortAndLongRequestsUseDifferentThreads) {
  const auto runs = [](const char* method, const std::string& target) {
    return match(method, "/v1/sessions" + target).route->runs;
  };
  for (const auto& [method, target] : {std::pair{"POST", "/x/undo"},
                                       {"POST", "/x/redo"},
                                       {"GET", "/x/strokes"},
                                       {"GET", "/x/authors"},
                                       {"POST", "/x/pins"},
                                       {"DELETE", "/x/pins/1"},
                                       {"POST", "/x/versions"},
                                       {"PATCH", "/x/versions/a"},
                                       {"DELETE", "/x/versions/a"},
                                       {"DELETE", "/x/targets/a.stl"}})
    EXPECT_EQ(runs(method, target), Runs::kHistory) << target;
  for (const auto& [method, target] : {std::pair{"POST", ""}, {"DELETE", "/x"}})
    EXPECT_EQ(runs(method, target), Runs::kWork) << target;
  for (const auto& [method, target] : {std::pair{"POST", "/x/programs"}, {"POST", "/x/targets"}})
    EXPECT_EQ(runs(method, target), Runs::kRead) << target;
  for (const char* target : {"/x/model.stl", "/x/program.ngc", "/x/forces", "/x/picture.png",
                             "/x/probe", "/x/replay", "/x/targets/a.stl/deviation"})
    EXPECT_EQ(runs("GET", target), Runs::kExport) << target;
  EXPECT_EQ(match("POST", "/v1/files").route->runs, Runs::kRead);
  EXPECT_EQ(match("POST", "/v1/programs").route->runs, Runs::kRead);
}

TEST(Routes, ViewersFilesAreTheFallback) {
  EXPECT_EQ(match("GET", "/").route->pattern, "/{file...}");
  EXPECT_EQ(match("GET", "/assets/app.js").route->pattern, "/{file...}");
  EXPECT_EQ(match("GET", "/metrics").route->pattern, "/metrics");
  EXPECT_EQ(match("PUT", "/metrics").allow, "GET, HEAD");
  for (const char* unknown : {"/v1", "/v1/x", "/v1/sessions/demo/x", "/v1/sessions/demo/view/x"}) {
    EXPECT_EQ(match("GET", unknown).allow, "") << unknown;
  }
}

TEST(Routes, BodyLimitsFollowTheRow) {
  const auto limit = [](const char* method, const char* target) {
    return body_bytes_max(match(method, target), method);
  };
  EXPECT_EQ(limit("POST", "/v1/sessions"), std::size_t{1} << 20);
  EXPECT_EQ(limit("POST", "/v1/files"), std::size_t{64} << 20);
  EXPECT_EQ(limit("POST", "/v1/sessions/demo/programs"), std::size_t{64} << 20);
  EXPECT_EQ(limit("GET", "/v1/sessions"), 0U);
  EXPECT_EQ(limit("DELETE", "/v1/sessions/demo"), 0U);
}

TEST(Routes, EveryRowIsReachable) {
  std::set<std::pair<std::string_view, std::string_view>> rows;
  for (const Route& route : table().all()) {
    EXPECT_TRUE(rows.emplace(route.methods, route.pattern).second) << route.pattern;
    EXPECT_NE(route.handler == nullptr && route.answer == nullptr, route.upgrade == Upgrade::kNone)
        << route.pattern;
    std::string target(route.pattern);
    for (auto open = target.find('{'); open != target.npos; open = target.find('{')) {
      target.replace(open, target.find('}') - open + 1, "x");
    }
    const auto method = route.methods.substr(0, route.methods.find(','));
    EXPECT_EQ(match(method, target).route, &route) << target;
  }
}

}  // namespace
}  // namespace kerf::net::route_table_test
