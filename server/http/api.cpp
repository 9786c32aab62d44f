// SPDX-License-Identifier: Apache-2.0
#include "server/http/api.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "server/http/static_files.h"
#include "server/session/hash_text.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kSceneBytesMax = std::size_t{1} << 20;
constexpr std::size_t kFileBytesMax = std::size_t{64} << 20;  ///< programs and meshes

ApiResponse json_response(unsigned status, const Json& json) {
  ApiResponse response;
  response.status = status;
  response.body = json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  return response;
}

ApiResponse wrong_method(const ApiRequest& request, const char* allowed) {
  auto response = error_response(405, "bad_method", request.method + " is not possible here");
  response.headers.emplace_back("Allow", allowed);
  return response;
}

bool is_read(const ApiRequest& request) {
  return request.method == "GET" || request.method == "HEAD";
}

Json info_json(const Session& session, const SessionInfo& info, const StateHash& hash) {
  Json people = Json::array();
  for (const Participant& who : info.participants) {
    people.push_back({{"participant", who.id},
                      {"name", who.name},
                      {"color", who.color},
                      {"kind", to_string(who.kind)},
                      {"tool", who.tool}});
  }
  return {{"id", info.id},
          {"name", session.scene().name},
          {"url", "/v1/sessions/" + info.id},
          {"epoch", info.epoch},
          {"state_hash", hash_text(hash.hash)},
          {"state_sequence", hash.sequence},
          {"motions", info.motions},
          {"sub_motions", info.sub_motions},
          {"stock_volume_mm3", info.stock_mm3},
          {"removed_volume_mm3", info.removed_mm3},
          {"journal_lag", info.journal_lag},
          {"pitch_mm", session.scene().settings.pitch_mm},
          {"accuracy", Json::parse(accuracy_json(session.scene()))},
          {"stock", Json::parse(stock_json(session.scene()))},
          {"tools", Json::parse(tools_json(session.scene()))},
          {"participants", people}};
}

unsigned http_status(RegistryErrorCode code) {
  switch (code) {
    case RegistryErrorCode::kBadId:
    case RegistryErrorCode::kBadScene:
      return 400;
    case RegistryErrorCode::kExists:
      return 409;
    case RegistryErrorCode::kUnknown:
      return 404;
    case RegistryErrorCode::kTooMany:
      return 503;
    case RegistryErrorCode::kJournal:
      return 500;
  }
  return 500;
}

ApiResponse registry_failure(const RegistryError& error) {
  return error_response(http_status(error.code), to_string(error.code), error.reason, error.path);
}

}  // namespace

ApiResponse error_response(unsigned status, std::string_view code, std::string_view reason,
                           std::string_view path) {
  Json error = {{"code", code}, {"reason", reason}};
  if (!path.empty()) error["path"] = path;
  return json_response(status, {{"error", error}});
}

Moment current_moment(Session& session) {
  struct Taken {
    SolidSnapshot solid;
    std::uint64_t sequence;
    std::optional<StateHash> hash;
  };
  Taken taken = run_and_wait(session.executor(), [&] {
    return Taken{session.solid(), session.sequence(), session.current_hash()};
  });
  if (taken.hash) return {std::move(taken.solid), *taken.hash};
  const StateHash hash{taken.sequence, taken.solid.hash()};
  session.executor().post([self = session.shared_from_this(), hash] { self->note_hash(hash); });
  return {std::move(taken.solid), hash};
}

Api::Api(const HttpOptions& options, SessionRegistry& registry, const Metrics& metrics)
    : options_(options),
      registry_(registry),
      metrics_(metrics),
      downloads_(options.data_folder / "downloads") {}

std::size_t Api::body_bytes_max(const ApiRequest& request) const {
  if (request.method != "POST") return 0;
  if (request.path.size() == 4 && request.path[3] == "programs") return kFileBytesMax;
  if (request.path.size() == 2 && request.path[1] == "files") return kFileBytesMax;
  return kSceneBytesMax;
}

bool Api::is_long(const ApiRequest& request) const {
  if (request.path.size() == 4 && request.path[3] == "exports") return false;
  return request.method == "POST" || request.path.size() == 4;
}

ApiResponse Api::handle(const ApiRequest& request) {
  const auto& path = request.path;
  if (!path.empty() && path[0] == "v1") return v1(request);
  if (!is_read(request)) return wrong_method(request, "GET, HEAD");
  if (path.size() == 1 && path[0] == "healthz") return json_response(200, {{"status", "ok"}});
  if (path.size() == 1 && path[0] == "metrics") {
    ApiResponse response;
    response.content_type = "text/plain; version=0.0.4; charset=utf-8";
    response.body = metrics_.text(registry_);
    return response;
  }
  return static_file(options_.web_folder, request);
}

ApiResponse Api::v1(const ApiRequest& request) {
  const auto& path = request.path;
  if (path.size() == 2 && path[1] == "files") return files(request);
  if (path.size() < 2 || path[1] != "sessions") {
    return error_response(404, "not_found", "there is nothing here");
  }
  if (path.size() == 2) return sessions(request);
  const auto found = registry_.find(path[2]);
  if (!found) return error_response(404, "unknown_session", "there is no session " + path[2]);
  if (path.size() == 3) return session(request, found);
  if (path[3] == "programs") return programs(request, found);
  if (path.size() == 4 && (path[3] == "agent" || path[3] == "view")) {
    auto response = error_response(426, "upgrade_required", "this address speaks WebSocket");
    response.headers.emplace_back("Upgrade", "websocket");
    return response;
  }
  if (path.size() == 4 && path[3] == "exports") return exports(request, found->id());
  if (path.size() == 4) return download(request, found);
  return error_response(404, "not_found", "there is nothing here");
}

ApiResponse Api::sessions(const ApiRequest& request) {
  if (request.method == "POST") return create_session(request);
  if (!is_read(request)) return wrong_method(request, "GET, HEAD, POST");
  Json list = Json::array();
  for (const auto& entry : registry_.list()) {
    const auto info = run_and_wait(entry->executor(), [&] { return entry->info(); });
    list.push_back({{"id", info.id},
                    {"name", entry->scene().name},
                    {"url", "/v1/sessions/" + info.id},
                    {"motions", info.motions},
                    {"removed_volume_mm3", info.removed_mm3},
                    {"participants", info.participants.size()}});
  }
  return json_response(200, {{"sessions", list}});
}

ApiResponse Api::create_session(const ApiRequest& request) {
  std::string id;
  if (const auto found = request.query.find("id"); found != request.query.end()) {
    id = found->second;
    if (!is_session_id(id)) {
      return error_response(400, "bad_id", "a session id is 1 to 64 of a-z, 0-9, - and _");
    }
  }
  // A scene that comes over the network must not read the server's files: it has no base folder,
  // and may name what was uploaded.
  SceneSource source;
  source.files = uploads_named_in(request.body);
  const auto created = registry_.create(id, request.body, source);
  if (!created) return registry_failure(created.error());
  const std::string url = "/v1/sessions/" + (*created)->id();
  Json created_json = {{"id", (*created)->id()}, {"url", url}};
  const Scene& scene = (*created)->scene();
  if (scene.accuracy) created_json["accuracy"] = Json::parse(accuracy_json(scene));
  auto response = json_response(201, created_json);
  response.headers.emplace_back("Location", url);
  return response;
}

ApiResponse Api::session(const ApiRequest& request, const SessionPtr& session) {
  if (request.method == "DELETE") {
    const auto purge = request.query.find("purge");
    const bool everything = purge != request.query.end() && purge->second == "1";
    if (auto ok = registry_.close(session->id(), everything); !ok) {
      return registry_failure(ok.error());
    }
    return json_response(200, {{"closed", session->id()}, {"purged", everything}});
  }
  if (!is_read(request)) return wrong_method(request, "GET, HEAD, DELETE");
  // The hash comes first: when nothing is being cut, both are of the same moment.
  const StateHash hash = current_moment(*session).hash;
  const auto info = run_and_wait(session->executor(), [&] { return session->info(); });
  return json_response(200, info_json(*session, info, hash));
}

}  // namespace kerf::net
