// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/api.h"
#include "server/rights/rights.h"

namespace kerf::net {

/// The protocol that a WebSocket upgrade of a route leads to.
enum class Upgrade : std::uint8_t { kNone, kAgent, kViewer };

/// The threads that a request runs on, by what it may wait for. All but kAtOnce have turns by
/// client (HttpContext); long ones end if the client is gone.
enum class Runs : std::uint8_t {
  kAtOnce,   ///< waits for nothing: cached figures, the viewer's files
  kSession,  ///< waits for a turn of its session's thread
  kHistory,  ///< short, but waits for the disk or the history of its session: undo, strokes, pins
  kWork,     ///< the beginning and the end of sessions
  kRead,     ///< long: programs and meshes of strangers are read
  kExport    ///< long: files made from a session, and what looks back
};

/// One row of the HTTP interface. Everything that depends on a request's path and method is decided
/// by this table: dispatch, 404, 405 with Allow, 426, body limits, worker threads, and the table of
/// README.md.
struct Route {
  using Handler = ApiResponse (Api::*)(const ApiCall&);

  /// Separated by ", ", in the order of the Allow header.
  std::string_view methods = "GET, HEAD";
  /// Segments separated by "/". "{name}" matches the rest of a segment and captures it; a last
  /// segment "{name...}" matches any number of segments outside /v1.
  std::string_view pattern;
  /// Names of the query parameters, separated by ", ", or kAnyQuery. "name=1" is a flag: 0 or 1. A
  /// request with another one is rejected (query_fault).
  std::string_view query = {};
  Handler handler = nullptr;
  /// The handler of a matter's route; `handler` is null.
  ApiResponse (*answer)(const ApiCall&) = nullptr;
  std::size_t body_bytes_max = 0;
  Runs runs = Runs::kAtOnce;
  Action action = Action::kAdminister;  ///< that the caller must have the right to
  Upgrade upgrade = Upgrade::kNone;
  std::string_view summary;  ///< for the README
};

/// Of the viewer's files: their query is for the page, and sites that pass a link on add to it.
inline constexpr std::string_view kAnyQuery = "*";

/// What the table knows of a request.
struct RouteMatch {
  const Route* route = nullptr;  ///< of the path and the method; null if there is none
  std::string allow;             ///< methods of all routes of the path; empty: the path is unknown
  Upgrade upgrade = Upgrade::kNone;  ///< of the path, whatever the method
  std::string captured;              ///< by the last "{name}" of the pattern
};
/// Whether the request only looks at a session's block and its history: a server that follows the
/// session serves it. Programs, targets, regions and people are known to its owner.
bool only_looks(const RouteMatch& match);

/// The most bytes that the body of the request may have.
std::size_t body_bytes_max(const RouteMatch& match, std::string_view method);

/// What is wrong with the query of a request to a route, as a 400: a parameter that the route does
/// not declare, one that comes twice, or a flag that is neither 0 nor 1. Nullopt: nothing.
std::optional<ApiResponse> query_fault(const Route& route, const ApiRequest& request);

/// The routes of the interface: its own and those of the matters.
class RouteTable {
 public:
  explicit RouteTable(std::span<const std::span<const Route>> matters);
  std::span<const Route> all() const { return routes_; }
  RouteMatch match(std::string_view method, const std::vector<std::string>& path) const;
  /// The table of README.md.
  std::string markdown() const;

 private:
  std::vector<Route> routes_;
};

}  // namespace kerf::net
