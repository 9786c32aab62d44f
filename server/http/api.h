// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/http/byte_range.h"
#include "server/http/download_cache.h"
#include "server/http/http_options.h"
#include "server/http/job_stops.h"
#include "server/http/page_preview.h"
#include "server/http/picture_cache.h"
#include "server/http/target_parts.h"
#include "server/http/upload_budget.h"
#include "server/http/upload_folder.h"
#include "server/metrics/metrics.h"
#include "server/rights/access.h"
#include "server/session/session_registry.h"
#include "server/threads/thread_pool.h"

namespace kerf::net {

struct Route;
struct RouteMatch;
class RouteTable;

/// An HTTP request as the interface sees it: no sockets, no Beast.
struct ApiRequest {
  std::string method;                        ///< GET, HEAD, POST, DELETE
  std::vector<std::string> path;             ///< decoded segments, e.g. {"v1", "sessions"}
  std::map<std::string, std::string> query;  ///< decoded; of a name that comes twice the first
  std::string repeated = {};                 ///< a name that comes twice; empty: none does
  std::string target;                        ///< path and query as they were sent
  std::string if_none_match, range, if_range, accept_encoding;
  std::string token;          ///< of the Authorization header, else `pass`; empty: none
  std::string pass;           ///< of the Cookie header; empty: none
  std::string host;           ///< as the client has addressed the server
  std::string network;        ///< of the client (network_of)
  bool is_secure = false;     ///< it has come over TLS
  bool is_script = false;     ///< of a page in a browser: it may not follow to another origin
  bool is_forwarded = false;  ///< a proxy has added the address of its client
  std::string body;
  /// Requested when the client is gone, the session is closed or the server stops.
  std::stop_token stop = {};

  /// The value of a query parameter; null if it is missing.
  const std::string* query_value(const std::string& name) const {
    const auto found = query.find(name);
    return found == query.end() ? nullptr : &found->second;
  }
};

struct ApiResponse {
  unsigned status = 200;
  std::string content_type = "application/json";
  std::string body;
  std::shared_ptr<const std::string> text;  ///< instead of a body: shared, not copied
  std::shared_ptr<const OpenFile> file;     ///< instead of a body
  std::optional<ByteRange> part;            ///< of the file; nothing: all of it
  std::vector<std::pair<std::string, std::string>> headers;
};

/// {"error":{"code","reason"}}, with "path" if a field of the scene is invalid.
ApiResponse error_response(unsigned status, std::string_view code, std::string_view reason,
                           std::string_view path = {});
ApiResponse error_response(const Error& error);
/// Waits until all that was recorded is on the disk: an answer with 2xx is durable. Returns 503 if
/// the disk fails, else nothing.
std::optional<ApiResponse> flush_failure(Session& session);
/// The response to a request that a session has rejected; `otherwise` is the status of errors that
/// no status belongs to whatever the request is.
ApiResponse rejection_response(const Rejection& rejection, unsigned otherwise);
ApiResponse not_found();
/// Whether a path is that of a session, or of something in it.
bool is_below_session(const std::vector<std::string>& path);
/// 307: the same request belongs to `location`, an absolute URL.
ApiResponse at_other_server(const std::string& reason, std::string location);
/// The response to a request for a session that is not open: 307 to the same `target` of the server
/// that runs it, 503 with Retry-After while it is being loaded or moved, 500 if its journal cannot
/// be read, otherwise 404.
ApiResponse no_session(const SessionRegistry& registry, const std::string& id,
                       const std::string& target);
/// Whether a session is not open yet, here or at another server, but soon will be. For a request
/// that only looks, also the copy of one that another server runs: this one is asked to follow it.
bool is_coming(const SessionRegistry& registry, const std::string& id, bool only_looks = false);
/// The session, for a request that only looks at it: also one that another server runs and this one
/// follows.
std::shared_ptr<Session> find_to_look(const SessionRegistry& registry, const std::string& id);
/// Where else a session runs: the address of that server; nullopt: nowhere, or there are no others.
std::optional<std::string> other_place(const SessionRegistry& registry, const std::string& id);
/// 500 `damaged_journal`: it names the bad record and what can be done.
ApiResponse damaged_journal(const JournalError& damage);
/// The response after the history of a session could not be read, for `reason`: 500 if its journal
/// is damaged, else 503: the request can be repeated. May read the journal.
ApiResponse history_failure(const Session& session, const std::string& reason,
                            const std::stop_token& stop);
/// 404: the session has no target part of that name.
ApiResponse unknown_target(const std::string& name);
/// 503 with Retry-After: the work on the request was ended (ApiRequest::stop).
ApiResponse stopped();
/// 503 with Retry-After: the memory for uploads and programs is used up.
ApiResponse out_of_memory();
/// A response whose body is the JSON text `json` and a line break.
ApiResponse json_response(unsigned status, std::string json);

/// Parses the path and query of a request target. The error names what is malformed.
std::expected<ApiRequest, std::string> parse_target(std::string_view target);

/// A solid and its hash.
struct HashedSolid {
  SolidSnapshot solid;
  StateHash hash;
  bool is_between_records = false;  ///< no replay gives it (Session::is_between_records)
};

/// A request to a route of the table (routes.h).
struct ApiCall {
  const ApiRequest& request;
  std::shared_ptr<Session> session;  ///< null outside /v1/sessions/{id}
  std::string captured;              ///< RouteMatch::captured
  Caller caller;                     ///< has the right to the route
};

/// The HTTP interface (README.md). Thread-safe. May block on a session's executor, so it must not
/// be called on one, nor on the viewers' thread.
class Api {
 public:
  /// `matters` are the routes of each matter.
  Api(const HttpOptions& options, SessionRegistry& registry, const Metrics& metrics, Access& access,
      std::span<const std::span<const Route>> matters = {});
  ~Api();

  const RouteTable& routes() const { return *routes_; }

  ApiResponse handle(const ApiRequest& request);
  /// The response to a caller without the right to a route, or with a query that is not one of the
  /// route (query_fault); nullopt: it has the right, and `caller` is who it is. Cheap enough to be
  /// asked before the body of a request is read.
  std::optional<ApiResponse> refuse(const ApiRequest& request, const RouteMatch& match,
                                    Caller& caller) const;
  /// The regions that are reserved in a session. Must be given to it before somebody may carve.
  void tell_regions(Session& session) const;
  /// Address of the server at which an administrator wants the sessions to go on; empty: none
  /// asked.
  std::string drain_target() const;
  /// The stop of a request that is about to be handled, for as long as it is kept: also requested
  /// when its session is closed, and by stop().
  JobStops::Source begin_job(std::string session) { return jobs_.begin(std::move(session)); }
  /// Ends the work on requests, and on later ones; files in preparation are cancelled.
  void stop() {
    jobs_.stop();
    downloads_.stop();
    pictures_.stop();
  }
  /// Leaves the disk to the journals, and not to downloads, where little space is left. Call now
  /// and then.
  void keep_space(const DiskUse& use, const DiskLimits& limits) {
    downloads_.keep_free(needed_for_sessions(use, limits));
  }
  /// Takes memory for a body that a client at `address` begins to send; 503 if there is none.
  std::expected<UploadBudget::Share, ApiResponse> begin_upload(const std::string& address,
                                                               std::size_t bytes);
  /// The most points of a program's path that are kept.
  static constexpr std::size_t kPathPointsMax = 20'000;

  // ---- handlers of the route table (routes.cpp) ----
  ApiResponse list_sessions(const ApiCall& call);
  ApiResponse create_session(const ApiCall& call);
  ApiResponse list_templates(const ApiCall& call);
  ApiResponse session_info(const ApiCall& call);
  ApiResponse close_session(const ApiCall& call);
  ApiResponse list_closed(const ApiCall& call);
  ApiResponse reopen_session(const ApiCall& call);
  ApiResponse delete_closed(const ApiCall& call);
  ApiResponse list_programs(const ApiCall& call);
  ApiResponse start_program(const ApiCall& call);
  ApiResponse describe_program(const ApiCall& call);
  ApiResponse program_status(const ApiCall& call);
  ApiResponse cancel_program(const ApiCall& call);
  ApiResponse change_program(const ApiCall& call);
  ApiResponse program_source(const ApiCall& call);
  ApiResponse program_path(const ApiCall& call);
  ApiResponse download(const ApiCall& call);
  ApiResponse list_exports(const ApiCall& call);
  ApiResponse list_targets(const ApiCall& call);
  ApiResponse set_target(const ApiCall& call);
  ApiResponse remove_target(const ApiCall& call);
  ApiResponse target_deviation(const ApiCall& call);
  ApiResponse target_distances(const ApiCall& call);
  ApiResponse picture(const ApiCall& call);
  ApiResponse probe(const ApiCall& call);
  ApiResponse owners(const ApiCall& call);
  ApiResponse replay(const ApiCall& call);
  ApiResponse journal_hashes(const ApiCall& call);
  ApiResponse journal_origin(const ApiCall& call);
  ApiResponse journal_records(const ApiCall& call);
  ApiResponse list_strokes(const ApiCall& call);
  ApiResponse list_authors(const ApiCall& call);
  ApiResponse undo(const ApiCall& call);
  ApiResponse redo(const ApiCall& call);
  ApiResponse list_invitations(const ApiCall& call);
  ApiResponse invite(const ApiCall& call);
  ApiResponse revoke(const ApiCall& call);
  ApiResponse redeem(const ApiCall& call);
  ApiResponse change_participant(const ApiCall& call);
  ApiResponse remove_participant(const ApiCall& call);
  ApiResponse list_regions(const ApiCall& call);
  ApiResponse reserve(const ApiCall& call);
  ApiResponse release(const ApiCall& call);
  ApiResponse upload_file(const ApiCall& call);
  ApiResponse drain(const ApiCall& call);
  ApiResponse health(const ApiCall& call);
  ApiResponse ready(const ApiCall& call);
  ApiResponse metrics(const ApiCall& call);
  ApiResponse viewer_file(const ApiCall& call);

 private:
  /// The response in place of one that was made while the session of the request was closed.
  std::optional<ApiResponse> gone_meanwhile(const ApiCall& call, const Route& route,
                                            const ApiResponse& response) const;
  /// The preview of a link to a session that everybody may watch; nothing for other requests.
  std::optional<PagePreview> preview_of(const ApiRequest& request) const;
  /// The response to a request for the page of a session of another server; nullopt: it is another.
  std::optional<ApiResponse> page_elsewhere(const ApiRequest& request) const;
  bool is_not_here(const std::string& id) const;
  /// A session comes with its attachments, or gets the rights and target parts that this server
  /// has kept for it as attachments. The error is one sentence.
  std::expected<void, std::string> adopt(Session& session, Opening opening);
  std::expected<void, std::string> adopt_targets(const std::string& id,
                                                 const std::vector<Attachment>& attachments);
  void attach_all(Session& session);
  /// Nothing of a session is kept here any more.
  void forget(const std::string& id);
  /// Attaches a target part as it is now, or removes it from the attachments.
  void attach_target(Session& session, const std::string& name);
  /// Mutes a participant, or ends that; for a person, also its other connections and later ones.
  AccessResult<void> mute(Session& session, ParticipantId id, const std::string& person,
                          bool muted);
  ApiResponse change_strokes(const ApiCall& call, bool undone);
  std::optional<ApiResponse> create_elsewhere(const ApiRequest& request);
  ApiResponse create_branch(const ApiCall& call, const std::string& id);
  ThreadPool& carvers();
  /// The solid of a session as it was after a record.
  std::expected<HashedSolid, ApiResponse> solid_after(const ApiCall& call, std::uint64_t record);
  /// The same after the record that the parameter `at` names; as it is without one.
  std::expected<HashedSolid, ApiResponse> requested_block(const ApiCall& call);
  std::expected<std::shared_ptr<const GougeReference>, ApiResponse> parse_target_part(
      const ApiCall& call);
  /// What a session of a scene would cost, as JSON.
  static std::string price_of(const Scene& scene);
  /// A share of the memory for programs. If it is used up, the texts of programs that have ended
  /// are dropped, in all sessions. Nothing if that does not suffice.
  std::optional<MemoryBudget::Share> program_memory(std::size_t bytes);

  const std::unique_ptr<const RouteTable> routes_;
  const HttpOptions& options_;
  SessionRegistry& registry_;
  const Metrics& metrics_;
  Access& access_;
  JobStops jobs_;
  DownloadCache downloads_;
  PictureCache pictures_;
  UploadBudget uploads_;
  MemoryBudget programs_;
  UploadFolder upload_folder_;
  TargetParts targets_;
  std::mutex attach_mutex_;  ///< the newest state of a part is the one that is attached last
  std::once_flag carvers_made_;
  std::unique_ptr<ThreadPool> carvers_;  ///< carve tiles for undo, redo and the past
  mutable std::mutex drain_mutex_;       ///< guards drain_to_
  std::string drain_to_;
};

/// The current solid of a session; computes its hash if it is not known yet.
HashedSolid current_solid(Session& session);

}  // namespace kerf::net
