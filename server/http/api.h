// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/http/api_call.h"
#include "server/http/api_services.h"
#include "server/http/job_stops.h"
#include "server/http/page_preview.h"
#include "server/http/session_lookup.h"
#include "server/http/upload_budget.h"
#include "server/metrics/metrics.h"
#include "server/rights/access.h"
#include "server/session/session_registry.h"

namespace kerf::net {

struct Route;
struct RouteMatch;
class RouteTable;

/// The HTTP interface (README.md). Thread-safe. May block on a session's executor, so it must not
/// be called on one, nor on the viewers' thread.
class Api {
 public:
  /// `options`, `registry`, `metrics` and `access` must outlive this object.
  Api(const HttpOptions& options, SessionRegistry& registry, const Metrics& metrics, Access& access,
      std::span<const HttpMatter> matters = {});
  ~Api();

  const RouteTable& routes() const { return *routes_; }

  ApiResponse handle(const ApiRequest& request);
  /// Returns the response to a caller without the right to a route, or with an invalid query
  /// (query_fault). Nullopt if the request may proceed; `caller` is then identified. Cheap enough
  /// to call before the body of a request is read.
  std::optional<ApiResponse> refuse(const ApiRequest& request, const RouteMatch& match,
                                    Caller& caller) const;
  /// Gives a session its reserved regions. Call before anybody can carve.
  void tell_regions(Session& session) const { net::tell_regions(session, access_); }
  /// Address of the server to which an administrator sends the sessions; empty if no drain was
  /// requested.
  std::string drain_target() const;
  /// Returns the stop of a request, in effect while it is kept. It is also requested when the
  /// request's session is closed, and by stop().
  JobStops::Source begin_job(std::string session) { return jobs_.begin(std::move(session)); }
  /// Stops the work on all current and future requests and cancels files in preparation.
  void stop() {
    jobs_.stop();
    services_.downloads.stop();
    services_.stores.stop();
  }
  /// Reserves scarce disk space for the journals by ending downloads. Call periodically.
  void keep_space(const DiskUse& use, const DiskLimits& limits) {
    services_.downloads.keep_free(needed_for_sessions(use, limits));
  }
  /// Reserves memory for a body that a client at `address` begins to send; a 503 if there is none.
  std::expected<UploadBudget::Share, ApiResponse> begin_upload(const std::string& address,
                                                               std::size_t bytes);

  // ---- handlers of the route table (routes.cpp) ----
  ApiResponse list_sessions(const ApiCall& call);
  ApiResponse create_session(const ApiCall& call);
  ApiResponse list_templates(const ApiCall& call);
  ApiResponse session_info(const ApiCall& call);
  ApiResponse rename_session(const ApiCall& call);
  ApiResponse close_session(const ApiCall& call);
  ApiResponse list_closed(const ApiCall& call);
  ApiResponse reopen_session(const ApiCall& call);
  ApiResponse delete_closed(const ApiCall& call);
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
  void attach_all(Session& session);
  /// Deletes all data that this server keeps for a session.
  void forget(const std::string& id);
  std::optional<ApiResponse> create_elsewhere(const ApiRequest& request);
  ApiResponse create_branch(const ApiCall& call, const std::string& id);

  const std::unique_ptr<const RouteTable> routes_;
  const HttpOptions& options_;
  SessionRegistry& registry_;
  const Metrics& metrics_;
  Access& access_;
  JobStops jobs_;
  ApiServices services_;
  UploadBudget uploads_;
  mutable std::mutex drain_mutex_;  ///< guards drain_to_
  std::string drain_to_;
};

}  // namespace kerf::net
