// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/byte_range.h"
#include "server/http/download_cache.h"
#include "server/http/http_options.h"
#include "server/metrics/metrics.h"

namespace kerf::net {

/// An HTTP request without HTTP: so that the interface can be understood, and tested, without
/// sockets.
struct ApiRequest {
  std::string method;                        ///< GET, HEAD, POST, DELETE
  std::vector<std::string> path;             ///< decoded segments, e.g. {"v1", "sessions"}
  std::map<std::string, std::string> query;  ///< decoded
  std::string if_none_match, range, if_range;
  std::string body;
};

struct ApiResponse {
  unsigned status = 200;
  std::string content_type = "application/json";
  std::string body;
  std::shared_ptr<const OpenFile> file;  ///< instead of a body
  std::optional<ByteRange> part;         ///< of the file; none: all of it
  std::vector<std::pair<std::string, std::string>> headers;
};

/// {"error":{"code","reason", and "path" where a field of the scene is to blame}}
ApiResponse error_response(unsigned status, std::string_view code, std::string_view reason,
                           std::string_view path = {});

/// The path and query of a request target; an error names what is malformed.
std::expected<ApiRequest, std::string> parse_target(std::string_view target);

/// The HTTP interface (README.md). Thread-safe; may block on a session's executor, so it is called
/// off both lanes.
class Api {
 public:
  Api(const HttpOptions& options, SessionRegistry& registry, const Metrics& metrics);

  /// Most bytes that a request to this path may carry; 0 where no body is expected.
  std::size_t body_bytes_max(const ApiRequest& request) const;
  /// True where the answer may take longer than a moment.
  bool is_long(const ApiRequest& request) const;
  ApiResponse handle(const ApiRequest& request);

 private:
  using SessionPtr = std::shared_ptr<Session>;
  ApiResponse v1(const ApiRequest& request);
  ApiResponse sessions(const ApiRequest& request);
  ApiResponse create_session(const ApiRequest& request);
  ApiResponse session(const ApiRequest& request, const SessionPtr& session);
  ApiResponse programs(const ApiRequest& request, const SessionPtr& session);
  ApiResponse start_program(const ApiRequest& request, const SessionPtr& session);
  ApiResponse download(const ApiRequest& request, const SessionPtr& session);
  ApiResponse exports(const ApiRequest& request, const std::string& session_id);
  ApiResponse files(const ApiRequest& request);
  /// The uploaded files whose names stand in a scene.
  std::map<std::string, std::string> uploads_named_in(std::string_view scene_text) const;
  std::filesystem::path upload_folder() const { return options_.data_folder / "uploads"; }

  const HttpOptions& options_;
  SessionRegistry& registry_;
  const Metrics& metrics_;
  DownloadCache downloads_;
};

/// The solid of one moment, and its hash.
struct Moment {
  SolidSnapshot solid;
  StateHash hash;
};
/// The newest state of the solid; its hash is computed here if nobody has yet.
Moment current_moment(Session& session);

}  // namespace kerf::net
