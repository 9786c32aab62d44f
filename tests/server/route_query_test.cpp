// SPDX-License-Identifier: Apache-2.0
// No route ignores an unknown query parameter.
#include <nlohmann/json.hpp>

#include "server/http/routes.h"
#include "server/matters.h"
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf::net::route_query_test {
namespace {

std::string target_of(const Route& route) {
  std::string target(route.pattern);
  if (const auto file = target.find("{file...}"); file != target.npos) target.erase(file);
  for (auto open = target.find('{'); open != target.npos; open = target.find('{')) {
    target.replace(open, target.find('}') - open + 1, "x");
  }
  return target;
}

/// The declared parameters, flags without "=1".
std::vector<std::string> parameters_of(const Route& route) {
  std::vector<std::string> names;
  for (const auto part : std::views::split(route.query, std::string_view(", "))) {
    std::string name(part.begin(), part.end());
    names.push_back(name.substr(0, name.find('=')));
  }
  return names;
}

class RouteQuery : public SessionTest {
 protected:
  void SetUp() override {
    matters = net::matters();
    SessionTest::SetUp();
    options_.data_folder = folder.path();
    access_ = *Access::open({});  // everybody has every right
    api_.emplace(options_, *registry, metrics_, *access_, http_matters());
  }
  /// Returns the response before a request's body is read; nullopt if the request may be handled.
  std::optional<ApiResponse> fault(const Route& route, const std::string& query) {
    ApiRequest request = *parse_target(target_of(route) + query);
    request.method = route.methods.substr(0, route.methods.find(','));
    const RouteMatch match = api_->routes().match(request.method, request.path);
    EXPECT_EQ(match.route, &route);
    Caller caller;
    return api_->refuse(request, match, caller);
  }
  static std::string code(const std::optional<ApiResponse>& response) {
    if (!response) return "none";
    EXPECT_EQ(response->status, 400U);
    return nlohmann::json::parse(response->body).at("error").at("code");
  }

  HttpOptions options_;
  Metrics metrics_;
  std::unique_ptr<Access> access_;
  std::optional<Api> api_;
};

TEST_F(RouteQuery, EveryRouteRejectsUndeclaredParameters) {
  for (const Route& route : api_->routes().all()) {
    const auto unknown = fault(route, "?another_one=1");
    if (route.query == kAnyQuery) {
      EXPECT_FALSE(unknown) << route.pattern;
      continue;
    }
    EXPECT_EQ(code(unknown), "unknown_parameter") << route.pattern;
    if (!unknown) continue;
    EXPECT_TRUE(unknown->body.contains("another_one")) << unknown->body;
    for (const std::string& name : parameters_of(route)) {
      EXPECT_TRUE(unknown->body.contains(name)) << unknown->body;
    }
  }
}

TEST_F(RouteQuery, EveryRouteRejectsRepeatedParameters) {
  for (const Route& route : api_->routes().all()) {
    if (route.query.empty() || route.query == kAnyQuery) continue;
    std::string all = "?";
    for (const std::string& name : parameters_of(route)) all += name + "=1&";
    EXPECT_FALSE(fault(route, all)) << route.pattern << all;
    for (const std::string& name : parameters_of(route)) {
      const auto twice = fault(route, "?" + name + "=1&" + name + "=1");
      EXPECT_EQ(code(twice), "repeated_parameter") << route.pattern;
      EXPECT_TRUE(twice && twice->body.contains(name)) << route.pattern;
    }
  }
}

TEST_F(RouteQuery, AFlagIsZeroOrOne) {
  std::size_t flags = 0;
  for (const Route& route : api_->routes().all()) {
    for (const auto part : std::views::split(route.query, std::string_view(", "))) {
      const std::string flag(part.begin(), part.end());
      if (!flag.ends_with("=1")) continue;
      ++flags;
      const std::string name = flag.substr(0, flag.size() - 2);
      for (const char* good : {"=0", "=1"}) EXPECT_FALSE(fault(route, "?" + name + good)) << name;
      for (const char* bad : {"", "=", "=2", "=true", "=yes"}) {
        EXPECT_EQ(code(fault(route, "?" + name + bad)), "bad_value") << name << bad;
      }
    }
  }
  EXPECT_GE(flags, 7U);
}

TEST_F(RouteQuery, MisspelledPointCreatesNoBranch) {
  const auto response =
      fault(*api_->routes().match("POST", {"v1", "sessions"}).route, "?from=block&at=1&id=other");
  EXPECT_EQ(code(response), "unknown_parameter");
  ASSERT_TRUE(response);
  EXPECT_TRUE(response->body.contains("id, from, name, dry_run, here")) << response->body;
}

TEST_F(RouteQuery, EmptyPartsOfAQueryAreIgnored) {
  EXPECT_FALSE(fault(*api_->routes().match("GET", {"healthz"}).route, "?&&"));
  EXPECT_FALSE(fault(*api_->routes().match("GET", {"healthz"}).route, "?"));
  EXPECT_EQ(code(fault(*api_->routes().match("GET", {"healthz"}).route, "?=1")),
            "unknown_parameter");
}

}  // namespace
}  // namespace kerf::net::route_query_test
