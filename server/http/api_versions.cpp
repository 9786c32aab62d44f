// SPDX-License-Identifier: Apache-2.0
// The routes that list, make and delete named versions.
#include <nlohmann/json.hpp>

#include "server/http/api.h"
#include "server/http/history_point.h"
#include "server/platform/clock.h"
#include "server/store/journal_times.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

std::string version_text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json version_json(const NamedVersion& version) {
  return {{"name", version.name},
          {"record", version.record},
          {"time_ms", version.record_ms},
          {"created_ms", version.created_ms},
          {"author", version.author}};
}

ApiResponse version_failure(const VersionError& error) {
  switch (error.fault) {
    case VersionFault::kUnknown:
      return error_response(404, "unknown_version", error.reason);
    case VersionFault::kTaken:
      return error_response(409, "version_exists", error.reason);
    case VersionFault::kNoRecord:
      return error_response(404, "no_record", error.reason);
    case VersionFault::kLimit:
      return error_response(409, "limit", error.reason);
    case VersionFault::kNotAllowed:
      return error_response(403, "not_allowed", error.reason);
    case VersionFault::kPaused:
      return error_response(503, "busy", error.reason);
  }
  return not_found();
}

/// Nothing if a version may have the name.
std::optional<ApiResponse> version_name_failure(const std::string* name) {
  if (name != nullptr && is_version_name(*name) && *name != kLive &&
      std::holds_alternative<std::string>(*parse_point(*name))) {
    return std::nullopt;
  }
  return error_response(400, "bad_name",
                        "name must be 1 to 64 bytes of text without control characters and /, "
                        "and no number, time or \"live\"");
}

}  // namespace

ApiResponse Api::list_versions(const ApiCall& call) {
  Json list = Json::array();
  const auto versions =
      run_and_wait(call.session->executor(), [&] { return call.session->versions(); });
  for (const NamedVersion& version : versions) {
    Json json = version_json(version);
    json["may_change"] = Session::may_change(version, call.caller);
    list.push_back(std::move(json));
  }
  return json_response(200, version_text({{"versions", list}}));
}

ApiResponse Api::name_version(const ApiCall& call) {
  Session& session = *call.session;
  const std::string* name = call.request.query_value("name");
  if (auto failure = version_name_failure(name)) return *std::move(failure);
  const auto record = find_requested(session, call.request.query_value("at"));
  if (!record) return record.error();
  if (const auto flushed = session.flush(); !flushed) {
    return error_response(503, "busy", describe(flushed.error()));
  }
  const auto time = time_of(session.journal_file(), *record);
  if (!time) return error_response(503, "journal_io", describe(time.error()));
  const NamedVersion version{*name,
                             *record,
                             *time,
                             Clock::wall_ms(),
                             call.caller.name,
                             call.caller.is_personal ? call.caller.grant : std::string()};
  const auto named =
      run_and_wait(session.executor(), [&] { return session.name_version(version); });
  if (!named) return version_failure(named.error());
  // What is answered is on the disk.
  if (const auto flushed = session.flush(); !flushed) {
    return error_response(503, "busy", describe(flushed.error()));
  }
  return json_response(201, version_text(version_json(version)));
}

ApiResponse Api::rename_version(const ApiCall& call) {
  Session& session = *call.session;
  const std::string* name = call.request.query_value("name");
  if (auto failure = version_name_failure(name)) return *std::move(failure);
  const auto renamed = run_and_wait(session.executor(), [&] {
    return session.rename_version(call.captured, *name, call.caller);
  });
  if (!renamed) return version_failure(renamed.error());
  if (const auto flushed = session.flush(); !flushed) {
    return error_response(503, "busy", describe(flushed.error()));
  }
  return json_response(200, version_text(version_json(*renamed)));
}

ApiResponse Api::remove_version(const ApiCall& call) {
  Session& session = *call.session;
  const auto removed = run_and_wait(
      session.executor(), [&] { return session.remove_version(call.captured, call.caller); });
  if (!removed) return version_failure(removed.error());
  if (const auto flushed = session.flush(); !flushed) {
    return error_response(503, "busy", describe(flushed.error()));
  }
  return json_response(200, version_text({{"deleted", call.captured}}));
}

}  // namespace kerf::net
