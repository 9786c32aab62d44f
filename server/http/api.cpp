// SPDX-License-Identifier: Apache-2.0
#include "server/http/api.h"

#include <nlohmann/json.hpp>

#include "server/http/browser_rules.h"
#include "server/http/responses.h"
#include "server/http/routes.h"
#include "server/http/session_lookup.h"
#include "server/http/static_files.h"
#include "server/rights/rights.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

/// Returns a 401 with its reason.
ApiResponse needs_token(const Caller& caller) {
  auto response = error_response(
      401, caller.has_bad_token ? "bad_token" : "no_token",
      caller.has_bad_token ? "the token is unknown here, has expired or was revoked"
                           : "this server needs a token: ask an owner of the session for a link");
  response.headers.emplace_back("WWW-Authenticate", "Bearer");
  return response;
}

}  // namespace

std::expected<UploadBudget::Share, ApiResponse> Api::begin_upload(const std::string& address,
                                                                  std::size_t bytes) {
  auto share = uploads_.take(network_of(address), bytes);
  if (share) return *std::move(share);
  if (share.error() == UploadBudget::Error::kNoneLeft) return std::unexpected(out_of_memory());
  ApiResponse response = error_response(503, "busy",
                                        "the unfinished uploads of one client may have " +
                                            std::to_string(uploads_.client_bytes()) +
                                            " bytes together; send one after the other");
  response.headers.emplace_back("Retry-After", "5");
  return std::unexpected(std::move(response));
}

Api::Api(const HttpOptions& options, SessionRegistry& registry, const Metrics& metrics,
         Access& access, std::span<const HttpMatter> matters)
    : routes_(std::make_unique<const RouteTable>(matters)),
      options_(options),
      registry_(registry),
      metrics_(metrics),
      access_(access),
      services_(options, registry, access, matters),
      uploads_(options.upload_bytes) {
  registry_.set_hooks(
      {[this](Session& session, Opening opening) { return adopt(session, opening); },
       [this](const std::string& id) {
         jobs_.end(id);
         if (!registry_.find_followed(id)) forget(id);
       }});
  access_.report_to([this](const std::string& id, AttachmentChange change) {
    if (const auto session = registry_.find(id)) session->attach(std::move(change));
  });
}

Api::~Api() = default;

ApiResponse Api::handle(const ApiRequest& request) {
  RouteMatch match = routes_->match(request.method, request.path);
  Caller caller;
  if (auto rejection = refuse(request, match, caller)) return *std::move(rejection);
  ApiCall call{request, nullptr, std::move(match.captured), std::move(caller), services_};
  if (is_below_session(request.path)) {
    const std::string& id = request.path[2];
    if (!call.caller.belongs_elsewhere) {
      call.session = only_looks(match) ? find_to_look(registry_, id) : registry_.find(id);
    }
    // Callers without rights learn nothing about sessions.
    const bool is_stranger = call.caller.role == Role::kNobody && !call.caller.belongs_elsewhere;
    if (!call.session)
      return is_stranger ? needs_token(call.caller) : no_session(registry_, id, request.target);
  }
  if (match.allow.empty()) return not_found();
  if (match.upgrade != Upgrade::kNone) {
    auto response =
        error_response(426, "upgrade_required", "this endpoint requires a WebSocket upgrade");
    response.headers.emplace_back("Upgrade", "websocket");
    return response;
  }
  if (match.route == nullptr) {
    auto response =
        error_response(405, "bad_method", "method " + request.method + " is not allowed");
    response.headers.emplace_back("Allow", match.allow);
    return response;
  }
  const Route& route = *match.route;
  ApiResponse response =
      route.answer != nullptr ? route.answer(call) : (this->*route.handler)(call);
  if (auto gone = gone_meanwhile(call, route, response)) return *std::move(gone);
  // A stopped request is neither the client's nor the server's fault, whatever the handler reports.
  const bool is_cut_short = response.status >= 400 && request.stop.stop_requested();
  return is_cut_short ? stopped() : std::move(response);
}

/// Replaces the response if the session was closed while the request was handled. Its journal is
/// then gone, or another session has taken the id, so results and errors read from it are
/// meaningless.
std::optional<ApiResponse> Api::gone_meanwhile(const ApiCall& call, const Route& route,
                                               const ApiResponse& response) const {
  if (!call.session || route.handler == &Api::close_session || registry_.is_stopping()) {
    return std::nullopt;
  }
  const std::string& id = call.session->id();
  if (registry_.find(id) == call.session || registry_.find_followed(id) == call.session) {
    return std::nullopt;
  }
  const bool reads_only = call.request.method == "GET" || call.request.method == "HEAD";
  const bool is_elsewhere = is_coming(registry_, id) || other_place(registry_, id).has_value();
  // A request that may have taken effect must not be repeated automatically at the next server.
  if (!reads_only && (response.status < 500 || is_elsewhere)) return std::nullopt;
  if (is_elsewhere) return no_session(registry_, id, call.request.target);
  return error_response(404, "unknown_session",
                        "session " + id + " was closed while the request was handled");
}

std::optional<ApiResponse> Api::refuse(const ApiRequest& request, const RouteMatch& match,
                                       Caller& caller) const {
  const bool is_below = is_below_session(request.path);
  if (request.is_forwarded && access_.regime() == Regime::kLocal) {
    return error_response(403, "forwarded",
                          "a proxy forwards this request, but the server has no rights: everybody "
                          "would be its administrator; start it with --admin-token-file or --open");
  }
  caller = access_.identify(request.token, is_below ? request.path[2] : "");
  caller.network = request.network;
  // The response to an unknown path below a session reveals whether the session exists.
  const Action unknown = is_below ? Action::kWatch : Action::kReach;
  const Action action = match.route != nullptr ? match.route->action : unknown;
  if (may(caller.role, action)) {
    return match.route != nullptr ? query_fault(*match.route, request) : std::nullopt;
  }
  caller.belongs_elsewhere = caller.has_bad_token && is_below &&
                             parse_access_token(request.token) && is_not_here(request.path[2]);
  if (caller.belongs_elsewhere) return std::nullopt;
  if (caller.has_bad_token || caller.role == Role::kNobody) return needs_token(caller);
  return error_response(403, wire::to_string(wire::ErrorCode::kNotAllowed),
                        "the role " + std::string(to_string(caller.role)) + " may not " +
                            std::string(to_string(action)) + "; it takes the role " +
                            std::string(to_string(lowest_invited(action))));
}

/// Whether a session runs at another server, is about to be opened, or is at a lost server.
bool Api::is_not_here(const std::string& id) const {
  return !registry_.find(id) &&
         (is_coming(registry_, id) || other_place(registry_, id) || needed_server(registry_, id));
}

ApiResponse Api::drain(const ApiCall& call) {
  const std::string* to = call.request.query_value("to");
  if (to == nullptr || !is_server_address(*to)) {
    return error_response(400, "bad_address", "to must be http:// or https://, a host and a port");
  }
  if (!options_.request_stop) {
    return error_response(409, "cannot_stop", "this server cannot be stopped by a request");
  }
  {
    const std::scoped_lock lock(drain_mutex_);
    drain_to_ = *to;
  }
  options_.request_stop();
  return json_response(202, Json{{"to", *to}}.dump());
}

std::string Api::drain_target() const {
  const std::scoped_lock lock(drain_mutex_);
  return drain_to_;
}

ApiResponse Api::health(const ApiCall&) { return json_response(200, R"({"status":"ok"})"); }

ApiResponse Api::ready(const ApiCall& call) {
  Json paused = Json::array(), damaged = Json::array();
  bool is_paused = false;
  for (const auto& session : registry_.list()) {
    // Stay ready: another server would read the same file, and this one can still carve.
    if (session->health().damage()) damaged.push_back(session->id());
    const auto error = session->pause();
    if (!error) continue;
    paused.push_back(session->id());
    // A session that has reached its own limit does not make the server unready.
    is_paused = is_paused || error->code != JournalErrorCode::kSessionLimit;
  }
  Json unreadable = Json::array();
  for (const UnreadableSession& session : registry_.unreadable()) {
    unreadable.push_back(session.id);
    // A load that failed because of the disk is retried, e.g. when the disk was full at the start.
    is_paused = is_paused || session.error.code == JournalErrorCode::kIo;
  }
  const bool loaded = registry_.loaded();
  const char* status = !loaded ? "loading" : is_paused ? "paused" : "ready";
  Json json = {{"status", status},
               {"loading", registry_.loading()},
               {"paused", paused},
               {"damaged", damaged},
               {"unreadable", unreadable}};
  // An invitation is for one session and does not allow the list.
  if (!may(call.caller.role, Action::kList) || !call.caller.grant.empty()) {
    for (const char* list : {"loading", "paused", "damaged", "unreadable"}) {
      json[list] = json[list].size();
    }
  }
  return json_response(loaded && !is_paused ? 200 : 503, json.dump());
}

ApiResponse Api::metrics(const ApiCall&) {
  ApiResponse response;
  response.content_type = "text/plain; version=0.0.4; charset=utf-8";
  response.body = metrics_.text(registry_);
  return response;
}

std::optional<PagePreview> Api::preview_of(const ApiRequest& request) const {
  const std::string* id = request.query_value("session");
  if (!request.path.empty() || id == nullptr || request.host.empty()) return std::nullopt;
  const auto session = registry_.find(*id);
  // Judge as a stranger: previews are made for strangers, whatever rights this browser has.
  if (!session || !may(access_.identify("", *id).role, Action::kWatch)) return std::nullopt;
  return PagePreview{session->scene()->name + " · Kerf",
                     (request.is_secure ? "https://" : "http://") + request.host + "/v1/sessions/" +
                         *id + "/picture.png?width=960"};
}

/// Redirects the page of a session that another server runs to that server.
std::optional<ApiResponse> Api::page_elsewhere(const ApiRequest& request) const {
  const std::string* id = request.query_value("session");
  if (!request.path.empty() || id == nullptr || registry_.find(*id)) return std::nullopt;
  if (!other_place(registry_, *id)) return std::nullopt;
  if (registry_.places()->wants_to_follow(*id)) return std::nullopt;
  if (!may(access_.identify(request.token, *id).role, Action::kWatch)) return std::nullopt;
  return no_session(registry_, *id, request.target);
}

ApiResponse Api::viewer_file(const ApiCall& call) {
  if (auto elsewhere = page_elsewhere(call.request)) return *std::move(elsewhere);
  const auto preview = preview_of(call.request);
  if (!preview) return static_file(options_.web_folder, call.request);
  ApiRequest plain = call.request;
  plain.accept_encoding.clear();
  plain.if_none_match.clear();
  ApiResponse page = static_file(options_.web_folder, plain);
  if (!page.file) return page;
  page.body.resize(page.file->bytes());
  page.file->read(0, page.body.data(), page.body.size());
  page.file.reset();
  page.body = with_preview(std::move(page.body), *preview);
  std::erase_if(page.headers, [](const auto& header) { return header.first == "ETag"; });
  return page;
}

}  // namespace kerf::net
