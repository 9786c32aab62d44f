// SPDX-License-Identifier: Apache-2.0
#include "server/http/api.h"

#include <nlohmann/json.hpp>

#include "server/http/browser_rules.h"
#include "server/http/routes.h"
#include "server/http/static_files.h"
#include "server/rights/rights.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

/// Subfolder of the data folder, for the server's own use only.
constexpr const char* kCacheFolder = ".kerf-cache";

/// Returns a 401 with its reason.
ApiResponse needs_token(const Caller& caller) {
  auto response = error_response(
      401, caller.has_bad_token ? "bad_token" : "no_token",
      caller.has_bad_token ? "the token is unknown here, has expired or was revoked"
                           : "this server needs a token: ask an owner of the session for a link");
  response.headers.emplace_back("WWW-Authenticate", "Bearer");
  return response;
}

/// The name of the lost server that alone can continue a session; nullopt if there is none.
std::optional<std::string> needed_server(const SessionRegistry& registry, const std::string& id) {
  return registry.places() == nullptr ? std::nullopt : registry.places()->needed_server(id);
}

}  // namespace

bool is_below_session(const std::vector<std::string>& path) {
  return path.size() > 2 && path[0] == "v1" && path[1] == "sessions";
}

bool is_coming(const SessionRegistry& registry, const std::string& id, bool only_looks) {
  if (registry.is_loading(id)) return true;
  if (registry.places() == nullptr) return false;
  if (registry.places()->is_moving(id)) return true;
  return only_looks && !registry.find(id) && registry.places()->wants_to_follow(id) &&
         !registry.find_followed(id);
}

std::shared_ptr<Session> find_to_look(const SessionRegistry& registry, const std::string& id) {
  auto session = registry.find(id);
  if (session || registry.places() == nullptr) return session;
  // This request counts as interest, so that the session keeps being followed.
  return registry.places()->wants_to_follow(id) ? registry.find_followed(id) : nullptr;
}

std::optional<std::string> other_place(const SessionRegistry& registry, const std::string& id) {
  return registry.places() == nullptr ? std::nullopt : registry.places()->address_of(id);
}

ApiResponse at_other_server(const std::string& reason, std::string location) {
  ApiResponse response = error_response(307, "other_server", reason);
  response.headers.emplace_back("Location", std::move(location));
  return response;
}

ApiResponse no_session(const SessionRegistry& registry, const std::string& id,
                       const std::string& target) {
  if (is_coming(registry, id) || registry.find(id)) {  // found now: it has just been opened
    ApiResponse response = error_response(503, "session_loading",
                                          "session " + id + " is being loaded; try again later");
    response.headers.emplace_back("Retry-After", "1");
    return response;
  }
  if (const auto address = other_place(registry, id)) {
    return at_other_server("session " + id + " is at " + *address, *address + target);
  }
  if (const auto node = needed_server(registry, id)) {
    return error_response(503, "server_lost",
                          "server " + *node + " ran session " + id +
                              " and is lost, and no other server has the journal: start it again");
  }
  if (const auto error = registry.unreadable(id)) {
    // The server retries the load after a disk error; damage is permanent.
    const unsigned status = error->code == JournalErrorCode::kIo ? 503 : 500;
    return error_response(status, "unreadable_session",
                          "the journal cannot be read and stays as it is: " + error->reason);
  }
  if (registry.is_stopping()) {  // 404 would be final for an agent
    ApiResponse response =
        error_response(503, "stopping", "the server is shutting down; try again later");
    response.headers.emplace_back("Retry-After", "1");
    return response;
  }
  return error_response(404, "unknown_session", "there is no session " + id);
}

ApiResponse stopped() {
  ApiResponse response = error_response(
      503, "stopped",
      "the work on the request was ended: its session was closed, or the server is shutting down");
  response.headers.emplace_back("Retry-After", "1");
  return response;
}

ApiResponse damaged_journal(const JournalError& damage) {
  return error_response(500, wire::to_string(wire::ErrorCode::kDamagedJournal),
                        damage_text(damage));
}

ApiResponse history_failure(const Session& session, const std::string& reason,
                            const std::stop_token& stop) {
  if (const auto damage = session.past().damage_after(reason, stop))
    return damaged_journal(*damage);
  return error_response(503, "busy", reason);
}

ApiResponse out_of_memory() {
  ApiResponse response = error_response(
      503, "busy", "uploads and running programs use all memory granted to them; try again later");
  response.headers.emplace_back("Retry-After", "5");
  return response;
}

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

HashedSolid current_solid(Session& session) {
  struct Read {
    SolidSnapshot solid;
    std::uint64_t sequence;
    std::optional<StateHash> hash;
    bool is_between_records;
  };
  Read read = run_and_wait(session.executor(), [&] {
    return Read{session.solid(), session.sequence(), session.current_hash(),
                session.is_between_records()};
  });
  if (read.hash) return {std::move(read.solid), *read.hash};
  const StateHash hash{read.sequence, read.solid.hash()};
  // The hash of a partly carved solid has no record: no replay gives it.
  if (read.is_between_records) return {std::move(read.solid), hash, true};
  session.executor().post([self = session.shared_from_this(), hash] { self->note_hash(hash); });
  return {std::move(read.solid), hash};
}

Api::Api(const HttpOptions& options, SessionRegistry& registry, const Metrics& metrics,
         Access& access, std::span<const std::span<const Route>> matters)
    : routes_(std::make_unique<const RouteTable>(matters)),
      options_(options),
      registry_(registry),
      metrics_(metrics),
      access_(access),
      downloads_(options.data_folder / kCacheFolder / "downloads"),
      pictures_(options.data_folder / kCacheFolder / "pictures"),
      uploads_(options.upload_bytes),
      programs_(options.program_bytes),
      upload_folder_(options.data_folder / "uploads"),
      targets_(options.data_folder / "targets") {
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
  ApiCall call{request, nullptr, std::move(match.captured), std::move(caller)};
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

void Api::tell_regions(Session& session) const {
  // Read the regions on the executor: after two concurrent changes, the later one must win.
  session.executor().post([self = session.shared_from_this(), &access = access_] {
    self->reserve(access.regions(self->id()));
  });
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
  return PagePreview{session->scene().name + " · Kerf",
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
