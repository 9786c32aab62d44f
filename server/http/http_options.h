// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "server/http/proxies.h"
#include "server/http/upload_pace.h"

namespace kerf::net {

struct HttpOptions {
  /// Memory for all uploads together, each from its header on until it has been handled.
  std::size_t upload_bytes = std::size_t{256} << 20;
  UploadPace upload_pace;
  /// Memory for all programs together, while they are read and until they end, and for the meshes
  /// that are read.
  std::size_t program_bytes = std::size_t{1536} << 20;
  std::filesystem::path data_folder = "kerf-data";
  std::filesystem::path web_folder;  ///< of the built viewer; empty: no viewer is served
  /// Names, besides IP addresses and localhost, by which clients may address the server. The
  /// command line adds the host name.
  std::vector<std::string> allow_hosts;
  std::vector<std::string> allow_origins;  ///< besides the server's own host, e.g.
                                           ///< "https://kerf.example"
  std::vector<std::string> embed_origins;  ///< of sites that may frame the page at `/?embed`
  /// The addresses of the other servers of a cluster, which the page of this one may use; empty:
  /// there are none.
  std::function<std::vector<std::string>()> other_servers;
  /// The addresses of those whose pages may use this server, with the pass that a browser has for
  /// it: also of servers that are gone, because their pages go on here. Empty: there are none.
  std::function<std::vector<std::string>()> page_servers;
  TrustedProxies proxies;
  /// Makes the process stop, soon; empty: it cannot be stopped by a request.
  std::function<void()> request_stop;
};

}  // namespace kerf::net
