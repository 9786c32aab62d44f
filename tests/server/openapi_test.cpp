// SPDX-License-Identifier: Apache-2.0
// The OpenAPI document describes the routes of the table, and nothing else.
#include "server/http/openapi.h"

#include <kerf/version.h>

#include <nlohmann/json.hpp>

#include "server/http/routes.h"
#include "server/matters.h"
#include "tests/server/api_rights_fixture.h"
#include "tests/support/test.h"

namespace kerf::net::openapi_test {
namespace {

using Names = std::set<std::string>;

const Json& document() {
  static const Json kDocument = Json::parse(openapi_text());
  return kDocument;
}

const Json& resolved(const Json& value) {
  if (!value.contains("$ref")) return value;
  return document().at(Json::json_pointer(value.at("$ref").get<std::string>().substr(1)));
}

Names split(std::string_view text) {
  Names parts;
  for (const auto part : std::views::split(text, std::string_view(", "))) {
    parts.emplace(part.begin(), part.end());
  }
  return parts;
}

/// The pattern of a route as OpenAPI writes it.
std::string template_of(const Route& route) {
  std::string text(route.pattern);
  if (const auto dots = text.find("...}"); dots != text.npos) text.erase(dots, 3);
  return text;
}

/// The names within braces.
Names captures_of(const std::string& path) {
  Names names;
  for (auto open = path.find('{'); open != path.npos; open = path.find('{', open + 1)) {
    names.insert(path.substr(open + 1, path.find('}', open) - open - 1));
  }
  return names;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// The described parameters of a kind; a flag ends in "=1", as in the table.
Names parameters_of(const Json& operation, const char* kind) {
  Names names;
  for (const Json& reference : operation.value("parameters", Json::array())) {
    const Json& parameter = resolved(reference);
    if (parameter.at("in") != kind) continue;
    std::string name = parameter.at("name");
    if (parameter.at("schema").value("enum", Json()) == Json({0, 1})) name += "=1";
    EXPECT_TRUE(names.insert(name).second) << name << " is described twice";
  }
  return names;
}

/// Calls `check(route, operation)` for each operation of the table that the document describes.
template <typename Check>
void for_each_operation(const Check& check) {
  const RouteTable table(http_matters());
  std::size_t checked = 0;
  for (const Route& route : table.all()) {
    const Json& paths = document().at("paths");
    if (!paths.contains(template_of(route))) continue;
    for (const std::string& method : split(route.methods)) {
      const Json& path = paths.at(template_of(route));
      if (!path.contains(lower(method))) continue;
      SCOPED_TRACE(method + " " + template_of(route));
      check(route, path.at(lower(method)));
      ++checked;
    }
  }
  EXPECT_GT(checked, 60U);
}

TEST(OpenApi, DescribesEachRouteOfTheTableAndNoOther) {
  const RouteTable table(http_matters());
  Names routes, described;
  for (const Route& route : table.all()) {
    for (const std::string& method : split(route.methods)) {
      if (method != "HEAD") routes.insert(lower(method) + " " + template_of(route));
    }
  }
  for (const auto& [path, operations] : document().at("paths").items()) {
    for (const auto& [method, operation] : operations.items()) {
      described.insert(method + " " + path);
    }
  }
  EXPECT_EQ(described, routes);
}

TEST(OpenApi, StatesThatHeadIsAnsweredWhereverGetIsExceptForWebSockets) {
  const RouteTable table(http_matters());
  for (const Route& route : table.all()) {
    const Names methods = split(route.methods);
    EXPECT_EQ(methods.contains("HEAD"), methods.contains("GET") && route.upgrade == Upgrade::kNone)
        << route.pattern;
  }
}

TEST(OpenApi, DescribesTheQueryParametersOfTheTable) {
  for_each_operation([](const Route& route, const Json& operation) {
    const Names known = route.query == kAnyQuery ? Names() : split(route.query);
    EXPECT_EQ(parameters_of(operation, "query"), known);
  });
}

TEST(OpenApi, DescribesTheParametersOfEachPath) {
  for_each_operation([](const Route& route, const Json& operation) {
    EXPECT_EQ(parameters_of(operation, "path"), captures_of(template_of(route)));
  });
}

TEST(OpenApi, StatesTheRightAndTheBodyOfEachRoute) {
  for_each_operation([](const Route& route, const Json& operation) {
    EXPECT_EQ(operation.at("x-kerf-right").get<std::string>(), to_string(route.action));
    EXPECT_EQ(operation.value("x-kerf-body-bytes-max", std::size_t{0}), route.body_bytes_max);
    EXPECT_EQ(operation.contains("requestBody"), route.body_bytes_max > 0);
  });
}

TEST(OpenApi, HasTheVersionOfTheServer) {
  EXPECT_EQ(document().at("info").at("version"), kVersion);
}

using OpenApiRoute = ApiRightsTest;

TEST_F(OpenApiRoute, AnybodyMayReadTheDocument) {
  const ApiResponse first = ask("GET", "/openapi.json", "");
  EXPECT_EQ(first.status, 200U);
  EXPECT_EQ(first.content_type, "application/json");
  ASSERT_TRUE(first.text);
  EXPECT_EQ(*first.text, openapi_text());
  ApiRequest again = *parse_target("/openapi.json");
  again.method = "GET";
  for (const auto& [name, value] : first.headers) {
    if (name == "ETag") again.if_none_match = value;
  }
  EXPECT_EQ(api->handle(again).status, 304U);
}

}  // namespace
}  // namespace kerf::net::openapi_test
