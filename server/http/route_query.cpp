// SPDX-License-Identifier: Apache-2.0
// Checks the query of a request against its route. A misspelled parameter, or one of another route,
// must be rejected: otherwise the request would do something else than intended.
#include <algorithm>

#include "server/http/responses.h"
#include "server/http/routes.h"

namespace kerf::net {
namespace {

constexpr std::string_view kFlag = "=1";

struct Parameter {
  std::string_view name;
  bool is_flag = false;
};

std::vector<Parameter> parameters_of(const Route& route) {
  std::vector<Parameter> parameters;
  std::string_view rest = route.query;
  while (!rest.empty()) {
    std::string_view one = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(one.size() + 2, rest.size()));
    const bool is_flag = one.ends_with(kFlag);
    if (is_flag) one.remove_suffix(kFlag.size());
    parameters.push_back({one, is_flag});
  }
  return parameters;
}

std::string names_of(const std::vector<Parameter>& parameters) {
  std::string names;
  for (const Parameter& one : parameters) {
    names.append(names.empty() ? "its parameters are " : ", ").append(one.name);
  }
  return names.empty() ? "it has none" : names;
}

}  // namespace

std::optional<ApiResponse> query_fault(const Route& route, const ApiRequest& request) {
  if (route.query == kAnyQuery) return std::nullopt;
  const auto parameters = parameters_of(route);
  for (const auto& [name, value] : request.query) {
    const auto known = std::ranges::find(parameters, name, &Parameter::name);
    if (known == parameters.end()) {
      return error_response(
          400, "unknown_parameter",
          "this route has no parameter \"" + name + "\": " + names_of(parameters));
    }
    if (known->is_flag && value != "0" && value != "1") {
      return error_response(400, "bad_value", name + " must be 0 or 1");
    }
  }
  if (request.repeated.empty()) return std::nullopt;
  return error_response(
      400, "repeated_parameter",
      "\"" + request.repeated + "\" comes twice: " + names_of(parameters) + ", each at most once");
}

}  // namespace kerf::net
