// SPDX-License-Identifier: Apache-2.0
// The routes that create, list, describe and close sessions.
#include <nlohmann/json.hpp>

#include "server/http/api.h"
#include "server/http/hashed_solid.h"
#include "server/http/history_point.h"
#include "server/http/registry_failure.h"
#include "server/http/responses.h"
#include "server/http/scene_price.h"
#include "server/http/session_lookup.h"
#include "server/rights/rights.h"
#include "server/session/hash_text.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

std::string to_text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json parent_json(const JournalParent& parent) {
  if (parent.session.empty()) return {};
  return {{"session", parent.session},
          {"record", parent.record},
          {"epoch", parent.epoch},
          {"branched_ms", parent.branched_ms}};
}

ApiResponse created_response(const Session& session) {
  const std::string url = "/v1/sessions/" + session.id();
  Json json = {{"id", session.id()}, {"url", url}};
  const std::shared_ptr<const Scene> shared = session.scene();
  const Scene& scene = *shared;
  if (scene.accuracy) json["accuracy"] = Json::parse(accuracy_json(scene));
  if (!session.parent().session.empty()) json["parent"] = parent_json(session.parent());
  auto response = json_response(201, to_text(json));
  response.headers.emplace_back("Location", url);
  return response;
}

/// Null for an unknown time.
Json time_json(std::int64_t ms) { return ms == 0 ? Json() : Json(ms); }

/// Null if the journal is not copied.
Json copy_json(const CopyNote& note) {
  const auto copy = note.get();
  if (!copy) return {};
  return {{"record", copy->record},
          {"fault", copy->fault.empty() ? Json() : Json(copy->fault)},
          {"snapshot", note.snapshot()}};
}

/// Null if no damage of the journal is known.
Json damage_json(const JournalHealth& health) {
  const auto damage = health.damage();
  if (!damage) return {};
  return {{"file", std::filesystem::path(damage->file).filename().string()},
          {"record", damage->sequence == 0 ? Json() : Json(damage->sequence)},
          {"reason", damage_text(*damage)}};
}

Json info_json(const Session& session, const SessionInfo& info, const StateHash& hash) {
  Json participants = Json::array();
  for (const Participant& participant : info.participants) {
    participants.push_back({{"participant", participant.id},
                            {"name", participant.name},
                            {"color", participant.color},
                            {"kind", to_string(participant.kind)},
                            {"tool", participant.tool}});
    if (participant.role == Role::kAdministrator) continue;
    participants.back()["role"] = to_string(participant.role);
    participants.back()["muted"] = participant.is_muted;
  }
  return {{"id", info.id},
          {"name", session.scene()->name},
          {"url", "/v1/sessions/" + info.id},
          {"created_ms", time_json(session.figures().created_ms)},
          {"active_ms", time_json(session.figures().active_ms)},
          {"epoch", info.epoch},
          {"parent", parent_json(session.parent())},
          {"state_hash", hash_text(hash.hash)},
          {"state_sequence", hash.sequence},
          {"motions", info.motions},
          {"sub_motions", info.sub_motions},
          {"stock_volume_mm3", info.stock_mm3},
          {"removed_volume_mm3", info.removed_mm3},
          {"imprint_volume_mm3", info.imprint_mm3},
          {"journal_lag", info.journal_lag},
          {"copied", copy_json(session.copy())},
          {"paused", info.paused.empty() ? Json() : Json(info.paused)},
          {"damaged", damage_json(session.health())},
          {"followed", session.is_followed()},
          {"disk_bytes", session.disk_bytes()},
          {"pitch_mm", session.scene()->settings.pitch_mm},
          {"accuracy", Json::parse(accuracy_json(*session.scene()))},
          {"stock", Json::parse(stock_json(*session.scene()))},
          {"tools", Json::parse(tools_json(*session.scene()))},
          {"participants", participants}};
}

Json pause_json(const Session& session) {
  const auto error = session.pause();
  return error ? Json(pause_word(error->code)) : Json();
}

Json placed_json(const PlacedSession& session) {
  return {{"id", session.id},
          {"name", session.name},
          {"url", session.address + "/v1/sessions/" + session.id},
          {"motions", session.motions},
          {"removed_volume_mm3", session.removed_mm3},
          {"paused", Json()},
          {"participants", session.participants},
          {"created_ms", time_json(session.created_ms)},
          {"active_ms", time_json(session.active_ms)},
          {"node", session.node}};
}

/// Adds the rights of the caller to an entry of the list of sessions.
void add_rights(Json& session, const Caller& caller) {
  session["may_rename"] = may(caller.role, Action::kRenameSession);
  session["may_close"] = may(caller.role, Action::kCloseSession);
}

/// Returns the target of a request with `here=1`, replacing `here=0`.
std::string with_here(const std::string& target) {
  const std::size_t mark = target.find('?');
  std::string changed = target.substr(0, mark) + "?";
  std::string_view query =
      mark == std::string::npos ? "" : std::string_view(target).substr(mark + 1);
  while (!query.empty()) {
    const auto pair = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(pair.size() + 1, query.size()));
    if (!pair.empty() && !pair.starts_with("here=")) changed.append(pair).append("&");
  }
  return changed + "here=1";
}

}  // namespace

ApiResponse Api::list_sessions(const ApiCall& call) {
  Json list = Json::array();
  const SessionPlaces* places = registry_.places();
  for (const auto& session : registry_.list()) {
    if (!call.caller.grant.empty() && session->id() != call.caller.session) continue;
    const SessionFigures figures = session->figures();
    list.push_back({{"id", session->id()},
                    {"name", session->scene()->name},
                    {"url", "/v1/sessions/" + session->id()},
                    {"motions", figures.motions},
                    {"removed_volume_mm3", figures.removed_mm3},
                    {"paused", pause_json(*session)},
                    {"participants", figures.participants},
                    {"created_ms", time_json(figures.created_ms)},
                    {"active_ms", time_json(figures.active_ms)}});
    add_rights(list.back(), call.caller);
    if (places != nullptr) list.back()["node"] = places->node();
  }
  if (places != nullptr) {
    for (const PlacedSession& session : places->elsewhere()) {
      if (!call.caller.grant.empty() && session.id != call.caller.session) continue;
      list.push_back(placed_json(session));
      add_rights(list.back(), call.caller);
    }
  }
  Json unreadable = Json::array();
  for (const UnreadableSession& session : registry_.unreadable()) {
    if (!call.caller.grant.empty() && session.id != call.caller.session) continue;
    unreadable.push_back({{"id", session.id},
                          {"code", to_string(session.error.code)},
                          {"reason", session.error.reason}});
  }
  auto loading = registry_.loading();
  std::erase_if(loading, [&](const std::string& id) {
    return !call.caller.grant.empty() && id != call.caller.session;
  });
  return json_response(
      200, to_text({{"sessions", list}, {"loading", loading}, {"unreadable", unreadable}}));
}

ApiResponse Api::create_session(const ApiCall& call) {
  std::string id;
  if (const std::string* given = call.request.query_value("id")) {
    id = *given;
    if (!is_session_id(id)) {
      return error_response(400, "bad_id",
                            "id must be 1 to 64 characters, each one of a-z, 0-9, - and _");
    }
  }
  const std::string* dry_run = call.request.query_value("dry_run");
  const bool is_dry = dry_run != nullptr && *dry_run == "1";
  if (call.request.query_value("from") != nullptr) {
    if (!is_dry) return create_branch(call, id);
    return error_response(400, "bad_request", "a dry run needs a scene: leave out from");
  }
  if (call.request.query_value("name") != nullptr) {
    return error_response(400, "bad_request", "name is that of a branch: name the scene itself");
  }
  // A scene from the network must not read the server's files: it has no base folder and may name
  // uploaded files only.
  SceneSource source;
  source.files = services_.uploads.named_in(call.request.body);
  source.stop = call.request.stop;
  if (is_dry) {
    const auto scene = registry_.check(id, call.request.body, source);
    if (!scene) return registry_failure(scene.error());
    return json_response(200, price_json(*scene, price_of_hand(*scene)));
  }
  if (source.files.empty()) {  // uploaded files exist on this server only
    if (auto elsewhere = create_elsewhere(call.request)) return *std::move(elsewhere);
  }
  const auto created = registry_.create(id, call.request.body, source);
  if (!created) return registry_failure(created.error());
  if (auto failure = flush_failure(**created)) return *std::move(failure);
  return created_response(**created);
}

/// Redirects the creation of a session to the server of the cluster with the fewest sessions.
/// `here` prevents loops: servers whose figures of each other are a second old could redirect a
/// client back and forth.
std::optional<ApiResponse> Api::create_elsewhere(const ApiRequest& request) {
  const std::string* here = request.query_value("here");
  const bool stays = request.is_script || (here != nullptr && *here == "1");
  if (stays || registry_.places() == nullptr) return std::nullopt;
  const auto address = registry_.places()->place_for_new();
  if (!address) return std::nullopt;
  return at_other_server("new sessions are created at " + *address,
                         *address + with_here(request.target));
}

ApiResponse Api::create_branch(const ApiCall& call, const std::string& id) {
  const std::string& from = *call.request.query_value("from");
  const std::size_t at = from.find('@');
  const auto parent = registry_.find(from.substr(0, at));
  if (!parent) return no_session(registry_, from.substr(0, at), call.request.target);
  if (!call.request.body.empty()) {
    return error_response(400, "bad_request", "name either a session in from or send a scene");
  }
  const std::string* const asked = call.request.query_value("name");
  const std::string name = asked == nullptr ? "" : *asked;
  if (asked != nullptr) {
    if (auto ok = registry_.check_name_free(name); !ok) return error_response(ok.error());
  }
  const std::string point = at == std::string::npos ? "" : from.substr(at + 1);
  const auto record = find_requested(*parent, at == std::string::npos ? nullptr : &point);
  if (!record) return record.error();
  const auto created = registry_.branch(id, *parent, *record, call.request.stop, {}, name);
  if (!created) return registry_failure(created.error());
  if (asked != nullptr) {
    if (auto named = registry_.rename(**created, name); !named) {
      (void)registry_.close((*created)->id(), true);  // the error is that of the request
      return error_response(named.error());
    }
  }
  if (auto failure = flush_failure(**created)) return *std::move(failure);
  return created_response(**created);
}

ApiResponse Api::rename_session(const ApiCall& call) {
  const std::string* name = call.request.query_value("name");
  const auto renamed = registry_.rename(*call.session, name == nullptr ? "" : *name);
  if (!renamed) return error_response(renamed.error());
  if (auto failure = flush_failure(*call.session)) return *std::move(failure);
  return json_response(200, to_text({{"id", call.session->id()}, {"name", *name}}));
}

ApiResponse Api::close_session(const ApiCall& call) {
  const std::string* value = call.request.query_value("purge");
  const bool purge = value != nullptr && *value == "1";
  // On a full disk the session stays open and keeps its rights.
  if (const auto flushed = call.session->flush(); !flushed && !purge) {
    return registry_failure({RegistryErrorCode::kNotClosed, stays_open(flushed.error()), {}});
  }
  // Delete the rights first, so that none apply to a later session with the same id.
  if (auto done = access_.forget(call.session->id()); !done) return error_response(done.error());
  call.session->attach({});
  const auto closed = registry_.close(call.session->id(), purge);
  jobs_.end(call.session->id());
  if (!closed) return registry_failure(closed.error());
  services_.stores.forget(call.session->id());
  return json_response(200, to_text({{"closed", call.session->id()}, {"purged", purge}}));
}

ApiResponse Api::list_closed(const ApiCall&) {
  Json list = Json::array();
  for (const ClosedSession& session : registry_.closed()) {
    list.push_back({{"name", session.name},
                    {"id", session.id},
                    {"bytes", session.bytes},
                    {"closed_s", session.closed_s == 0 ? Json() : Json(session.closed_s)}});
  }
  return json_response(200, to_text({{"closed", list}}));
}

ApiResponse Api::reopen_session(const ApiCall& call) {
  LoadReport report;
  const auto reopened = registry_.reopen(call.captured, report);
  if (!reopened) return registry_failure(reopened.error());
  if (auto failure = flush_failure(**reopened)) return *std::move(failure);
  const std::string url = "/v1/sessions/" + (*reopened)->id();
  const bool recarved = !report.recarved.empty();
  auto response = json_response(
      201, to_text({{"id", (*reopened)->id()}, {"url", url}, {"recarved", recarved}}));
  response.headers.emplace_back("Location", url);
  return response;
}

ApiResponse Api::delete_closed(const ApiCall& call) {
  if (auto ok = registry_.delete_closed(call.captured); !ok) return registry_failure(ok.error());
  return json_response(200, to_text({{"deleted", call.captured}}));
}

ApiResponse Api::session_info(const ApiCall& call) {
  Session& session = *call.session;
  // Read the hash first: unless the session is being cut, it matches the information.
  const StateHash hash = current_solid(session).hash;
  const auto info = run_and_wait(session.executor(), [&] { return session.info(); });
  return json_response(200, to_text(info_json(session, info, hash)));
}

}  // namespace kerf::net
