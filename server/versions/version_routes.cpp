// SPDX-License-Identifier: Apache-2.0
#include "server/versions/version_routes.h"

#include <nlohmann/json.hpp>

#include "server/http/history_point.h"
#include "server/http/responses.h"
#include "server/http/routes.h"
#include "server/platform/clock.h"
#include "server/session/session.h"
#include "server/store/journal_times.h"
#include "server/threads/run_and_wait.h"
#include "server/versions/versions.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

Versions& versions_of(Session& session) { return session.matters().get<Versions>(); }

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json version_json(const NamedVersion& version) {
  return {{"name", version.name},
          {"record", version.record},
          {"time_ms", version.record_ms},
          {"created_ms", version.created_ms},
          {"author", version.author}};
}

/// Returns a 400 for an invalid name of a version, else nullopt.
std::optional<ApiResponse> name_failure(const std::string* name) {
  if (name != nullptr && is_point_name(*name) && *name != kLive &&
      std::holds_alternative<std::string>(*parse_point(*name))) {
    return std::nullopt;
  }
  return error_response(400, "bad_name",
                        "name must be 1 to 64 bytes of text without control characters and /, "
                        "and no number, time or \"live\"");
}

ApiResponse list_versions(const ApiCall& call) {
  Json list = Json::array();
  Session& session = *call.session;
  const auto versions =
      run_and_wait(session.executor(), [&] { return versions_of(session).list(); });
  for (const NamedVersion& version : versions) {
    Json json = version_json(version);
    json["may_change"] = Versions::may_change(version, call.caller);
    list.push_back(std::move(json));
  }
  return json_response(200, text_of({{"versions", list}}));
}

ApiResponse name_version(const ApiCall& call) {
  Session& session = *call.session;
  const std::string* name = call.request.query_value("name");
  if (auto failure = name_failure(name)) return *std::move(failure);
  const auto record = find_requested(session, call.request.query_value("at"));
  if (!record) return record.error();
  // The time of the record is read from the file.
  if (auto failure = flush_failure(session)) return *std::move(failure);
  const auto time = time_of(session.journal_file(), *record);
  if (!time) return error_response(503, "journal_io", describe(time.error()));
  const NamedVersion version{*name,
                             *record,
                             *time,
                             Clock::wall_ms(),
                             call.caller.name,
                             call.caller.is_personal ? call.caller.grant : std::string()};
  const auto named =
      run_and_wait(session.executor(), [&] { return versions_of(session).name(version); });
  if (!named) return error_response(named.error());
  if (auto failure = flush_failure(session)) return *std::move(failure);
  return json_response(201, text_of(version_json(version)));
}

ApiResponse rename_version(const ApiCall& call) {
  Session& session = *call.session;
  const std::string* name = call.request.query_value("name");
  if (auto failure = name_failure(name)) return *std::move(failure);
  const auto renamed = run_and_wait(session.executor(), [&] {
    return versions_of(session).rename(call.captured, *name, call.caller);
  });
  if (!renamed) return error_response(renamed.error());
  if (auto failure = flush_failure(session)) return *std::move(failure);
  return json_response(200, text_of(version_json(*renamed)));
}

ApiResponse remove_version(const ApiCall& call) {
  Session& session = *call.session;
  const auto removed = run_and_wait(
      session.executor(), [&] { return versions_of(session).remove(call.captured, call.caller); });
  if (!removed) return error_response(removed.error());
  if (auto failure = flush_failure(session)) return *std::move(failure);
  return json_response(200, text_of({{"deleted", call.captured}}));
}

constexpr Route kRoutes[] = {
    {.pattern = "/v1/sessions/{id}/versions",
     .answer = &list_versions,
     .runs = Runs::kSession,
     .action = Action::kWatch},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/versions",
     .query = "name, at",
     .answer = &name_version,
     .runs = Runs::kHistory,
     .action = Action::kNameVersions},
    {.methods = "PATCH",
     .pattern = "/v1/sessions/{id}/versions/{name}",
     .query = "name",
     .answer = &rename_version,
     .runs = Runs::kHistory,
     .action = Action::kNameVersions},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}/versions/{name}",
     .answer = &remove_version,
     .runs = Runs::kHistory,
     .action = Action::kNameVersions},
};

}  // namespace

HttpMatter http_versions() { return {.routes = kRoutes}; }

}  // namespace kerf::net
