// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
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

#include "server/formats/program_error.h"
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

/// An HTTP request, independent of sockets and Beast.
struct ApiRequest {
  std::string method;                        ///< GET, HEAD, POST, DELETE
  std::vector<std::string> path;             ///< decoded segments, e.g. {"v1", "sessions"}
  std::map<std::string, std::string> query;  ///< decoded; the first value of a repeated name
  std::string repeated = {};                 ///< name of a repeated parameter; empty if none
  std::string target;                        ///< path and query as sent
  std::string if_none_match, range, if_range, accept_encoding;
  std::string token;          ///< from the Authorization header, else `pass`; empty if none
  std::string pass;           ///< from the Cookie header; empty if none
  std::string host;           ///< as addressed by the client
  std::string network;        ///< of the client (network_of)
  bool is_secure = false;     ///< received over TLS
  bool is_script = false;     ///< sent by a page, whose browser may not follow to another origin
  bool is_forwarded = false;  ///< a proxy has added its client's address
  std::string body;
  /// Requested when the client is gone, the session is closed or the server stops.
  std::stop_token stop = {};

  /// Returns the value of a query parameter; null if it is missing.
  const std::string* query_value(const std::string& name) const {
    const auto found = query.find(name);
    return found == query.end() ? nullptr : &found->second;
  }
};

struct ApiResponse {
  unsigned status = 200;
  std::string content_type = "application/json";
  std::string body;
  std::shared_ptr<const std::string> text;  ///< shared body, instead of `body`
  std::shared_ptr<const OpenFile> file;     ///< file body, instead of `body`
  std::optional<ByteRange> part;            ///< part of the file to send; nullopt for all of it
  std::vector<std::pair<std::string, std::string>> headers;
};

/// Returns {"error":{"code","reason"}}, with "path" if a field of the scene is invalid.
ApiResponse error_response(unsigned status, std::string_view code, std::string_view reason,
                           std::string_view path = {});
ApiResponse error_response(const Error& error);
/// The response after an exception: 503 if memory was short, else 500.
ApiResponse exception_response(const std::exception& error);
/// Blocks until everything recorded is durable (SessionJournal::flush_and_copy), so that a 2xx
/// answer means durable. Returns a 503 if the disk or the copy fails, else nullopt.
std::optional<ApiResponse> flush_failure(Session& session);
/// Returns the response to a request that a session has rejected. `otherwise` is the status of
/// errors whose status depends on the request.
ApiResponse rejection_response(const Rejection& rejection, unsigned otherwise);
ApiResponse not_found();
/// Whether a path is that of a session or below it.
bool is_below_session(const std::vector<std::string>& path);
/// Returns a 307 to `location`, an absolute URL for the same request.
ApiResponse at_other_server(const std::string& reason, std::string location);
/// Returns the response for a session that is not open: a 307 to `target` at the server that runs
/// it, a 503 with Retry-After while it is being loaded or moved, a 503 `server_lost` if its server
/// is lost and nobody else has the journal, a 500 if its journal cannot be read, otherwise a 404.
ApiResponse no_session(const SessionRegistry& registry, const std::string& id,
                       const std::string& target);
/// Whether a session is not open yet but soon will be, here or at another server. With
/// `only_looks`, asks this server to follow another server's session, and also returns true until
/// it does.
bool is_coming(const SessionRegistry& registry, const std::string& id, bool only_looks = false);
/// Finds the session for a request that only looks at it: an own session, or one that this server
/// follows.
std::shared_ptr<Session> find_to_look(const SessionRegistry& registry, const std::string& id);
/// The address of the other server that runs a session; nullopt if there is none.
std::optional<std::string> other_place(const SessionRegistry& registry, const std::string& id);
/// Returns a 500 `damaged_journal` that names the bad record and the remedy.
ApiResponse damaged_journal(const JournalError& damage);
/// Returns the response after reading the history of a session has failed for `reason`: a 500 if
/// its journal is damaged, else a 503, because a retry may succeed. May read the journal.
ApiResponse history_failure(const Session& session, const std::string& reason,
                            const std::stop_token& stop);
/// Returns a 404: the session has no target part with this name.
ApiResponse unknown_target(const std::string& name);
/// Returns a 503 with Retry-After: the work on the request was stopped (ApiRequest::stop).
ApiResponse stopped();
/// Returns a 503 with Retry-After: the memory for uploads and programs is exhausted.
ApiResponse out_of_memory();
/// Returns the response for a scene that is invalid, or a session that cannot be created.
ApiResponse registry_failure(const RegistryError& error);
/// Returns a 400 `bad_program` with the line and the word.
ApiResponse program_failure(const ProgramError& error);
/// Returns a 400 for an invalid name of a program, else nullopt.
std::optional<ApiResponse> program_name_failure(const std::string& name);
/// Returns a response with the JSON text `json` and a line break as body.
ApiResponse json_response(unsigned status, std::string json);

/// Parses the path and query of a request target. The error names the malformed part.
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
  std::shared_ptr<Session> session;  ///< the session in the path; null if the path is not below one
  std::string captured;              ///< RouteMatch::captured
  Caller caller;                     ///< its right to the route has been checked
};

/// The HTTP interface (README.md). Thread-safe. May block on a session's executor, so it must not
/// be called on one, nor on the viewers' thread.
class Api {
 public:
  /// `matters`: the routes of each matter.
  Api(const HttpOptions& options, SessionRegistry& registry, const Metrics& metrics, Access& access,
      std::span<const std::span<const Route>> matters = {});
  ~Api();

  const RouteTable& routes() const { return *routes_; }

  ApiResponse handle(const ApiRequest& request);
  /// Returns the response to a caller without the right to a route, or with an invalid query
  /// (query_fault). Nullopt if the request may proceed; `caller` is then identified. Cheap enough
  /// to call before the body of a request is read.
  std::optional<ApiResponse> refuse(const ApiRequest& request, const RouteMatch& match,
                                    Caller& caller) const;
  /// Gives a session its reserved regions. Call before anybody can carve.
  void tell_regions(Session& session) const;
  /// Address of the server to which an administrator sends the sessions; empty if no drain was
  /// requested.
  std::string drain_target() const;
  /// Returns the stop of a request, in effect while it is kept. It is also requested when the
  /// request's session is closed, and by stop().
  JobStops::Source begin_job(std::string session) { return jobs_.begin(std::move(session)); }
  /// Stops the work on all current and future requests and cancels files in preparation.
  void stop() {
    jobs_.stop();
    downloads_.stop();
    pictures_.stop();
  }
  /// Reserves scarce disk space for the journals by ending downloads. Call periodically.
  void keep_space(const DiskUse& use, const DiskLimits& limits) {
    downloads_.keep_free(needed_for_sessions(use, limits));
  }
  /// Reserves memory for a body that a client at `address` begins to send; a 503 if there is none.
  std::expected<UploadBudget::Share, ApiResponse> begin_upload(const std::string& address,
                                                               std::size_t bytes);
  /// Maximum number of points that are kept of a program's path.
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
  ApiResponse price_program(const ApiCall& call);
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
  ApiResponse describe_interface(const ApiCall& call);
  ApiResponse viewer_file(const ApiCall& call);

 private:
  /// Returns the replacement of a response whose session was closed while the request was handled.
  std::optional<ApiResponse> gone_meanwhile(const ApiCall& call, const Route& route,
                                            const ApiResponse& response) const;
  /// Returns the preview of a link to a session that everybody may watch; nullopt for other
  /// requests.
  std::optional<PagePreview> preview_of(const ApiRequest& request) const;
  /// Returns a redirect for the page of another server's session; nullopt for other requests.
  std::optional<ApiResponse> page_elsewhere(const ApiRequest& request) const;
  bool is_not_here(const std::string& id) const;
  /// Takes over a session with its attachments. If its journal has none, attaches the rights and
  /// target parts that this server has kept for it. The error is one sentence.
  std::expected<void, std::string> adopt(Session& session, Opening opening);
  std::expected<void, std::string> adopt_targets(const std::string& id,
                                                 const std::vector<Attachment>& attachments);
  void attach_all(Session& session);
  /// Deletes all data that this server keeps for a session.
  void forget(const std::string& id);
  /// Attaches the current state of a target part, or its removal.
  void attach_target(Session& session, const std::string& name);
  /// Mutes or unmutes a participant; a person also on its other and later connections.
  AccessResult<void> mute(Session& session, ParticipantId id, const std::string& person,
                          bool muted);
  ApiResponse change_strokes(const ApiCall& call, bool undone);
  std::optional<ApiResponse> create_elsewhere(const ApiRequest& request);
  ApiResponse create_branch(const ApiCall& call, const std::string& id);
  ThreadPool& carvers();
  /// The solid of a session as of a record.
  std::expected<HashedSolid, ApiResponse> solid_after(const ApiCall& call, std::uint64_t record);
  /// The solid as of the point named by the parameter `at`, or the current one.
  std::expected<HashedSolid, ApiResponse> requested_block(const ApiCall& call);
  std::expected<std::shared_ptr<const GougeReference>, ApiResponse> parse_target_part(
      const ApiCall& call);
  /// Estimates the cost of a session of a scene, as JSON.
  static std::string price_of(const Scene& scene);
  /// Takes a share of the memory for programs. If it is exhausted, drops the texts of ended
  /// programs in all sessions. Nullopt if that is not enough.
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
  std::mutex attach_mutex_;  ///< the newest state of a part must be attached last
  std::once_flag carvers_made_;
  std::unique_ptr<ThreadPool> carvers_;  ///< carve tiles for undo, redo and the past
  mutable std::mutex drain_mutex_;       ///< guards drain_to_
  std::string drain_to_;
};

/// The current solid of a session. Computes its hash if it is unknown.
HashedSolid current_solid(Session& session);

}  // namespace kerf::net
