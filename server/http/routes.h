// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/model/model_limits.h"
#include "server/http/api_call.h"
#include "server/http/matter_store.h"
#include "server/rights/rights.h"

namespace kerf::net {

class Api;

/// The protocol that a WebSocket upgrade of a route leads to.
enum class Upgrade : std::uint8_t { kNone, kAgent, kViewer };

/// The threads that handle a request. A request runs where its longest wait harms nobody else. All
/// but kAtOnce take turns by client (HttpContext). Long requests end when the client is gone.
enum class Runs : std::uint8_t {
  kAtOnce,   ///< never blocks: cached figures, the viewer's files
  kSession,  ///< waits for a turn of its session's thread
  kHistory,  ///< short, but waits for the disk or the session's history: undo, strokes, pins
  kWork,     ///< opens or closes sessions
  kRead,     ///< long: parses uploaded programs and meshes
  kExport    ///< long: makes files from a session, or looks back
};

/// One row of the HTTP interface. The table decides everything that depends on path and method:
/// dispatch, 404, 405 with Allow, 426, body limits and threads.
struct Route {
  using Handler = ApiResponse (Api::*)(const ApiCall&);

  /// Separated by ", ", in the order of the Allow header.
  std::string_view methods = "GET, HEAD";
  /// Segments separated by "/". "{name}" matches the rest of a segment and captures it; a last
  /// segment "{name...}" matches any number of segments outside /v1.
  std::string_view pattern;
  /// Names of the query parameters, separated by ", ", or kAnyQuery. "name=1" is a flag: 0 or 1.
  /// Any other parameter is rejected (query_fault).
  std::string_view query = {};
  Handler handler = nullptr;
  /// The handler of a matter's route; `handler` is null.
  ApiResponse (*answer)(const ApiCall&) = nullptr;
  std::size_t body_bytes_max = 0;
  Runs runs = Runs::kAtOnce;
  Action action = Action::kAdminister;  ///< the caller needs the right to it
  Upgrade upgrade = Upgrade::kNone;
  bool at_owner = false;  ///< a server that follows the session cannot answer
};

/// Limits of bodies: points of the surface (262,144), and programs and meshes.
inline constexpr std::size_t kPointBytesMax = std::size_t{3} << 20;
inline constexpr std::size_t kFileBytesMax = kModelBytesMax;

/// For the viewer's files: their query is for the page, and sites that pass a link on add to it.
inline constexpr std::string_view kAnyQuery = "*";

/// The result of looking up a request.
struct RouteMatch {
  const Route* route = nullptr;  ///< matches path and method; null if none does
  std::string allow;             ///< methods of all routes of the path; empty for an unknown path
  Upgrade upgrade = Upgrade::kNone;  ///< matches the path, with any method
  std::string captured;              ///< by the pattern's last "{name}"
};
/// Whether the request only looks at a session's block and history, so that a server that follows
/// the session can serve it.
bool only_looks(const RouteMatch& match);

/// Maximum size of the request's body.
std::size_t body_bytes_max(const RouteMatch& match, std::string_view method);

/// Returns a 400 for a query with an undeclared parameter, a repeated one, or a flag that is
/// neither 0 nor 1. Nullopt if the query is valid.
std::optional<ApiResponse> query_fault(const Route& route, const ApiRequest& request);

/// The routes of the interface: its own and those of the matters.
class RouteTable {
 public:
  explicit RouteTable(std::span<const HttpMatter> matters);
  std::span<const Route> all() const { return routes_; }
  RouteMatch match(std::string_view method, const std::vector<std::string>& path) const;

 private:
  std::vector<Route> routes_;
};

}  // namespace kerf::net
