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
  /// Memory for all uploads, each from its header until it has been handled.
  std::size_t upload_bytes = std::size_t{256} << 20;
  UploadPace upload_pace;
  /// Memory for all programs, from reading until they end, and for meshes being read.
  std::size_t program_bytes = std::size_t{1536} << 20;
  std::filesystem::path data_folder = "kerf-data";
  std::filesystem::path web_folder;  ///< folder of the built viewer; if empty, no viewer is served
  /// Names by which clients may address the server, besides IP addresses and localhost. The command
  /// line adds the host name.
  std::vector<std::string> allow_hosts;
  std::vector<std::string> allow_origins;  ///< besides the server's own host, e.g.
                                           ///< "https://kerf.example"
  std::vector<std::string> embed_origins;  ///< of sites that may frame the page at `/?embed`
  /// Addresses of the other servers of a cluster, which this server's page may use; empty if none.
  std::function<std::vector<std::string>()> other_servers;
  /// Addresses of the servers whose pages may use this server, with a browser's pass for it.
  /// Includes servers that are gone, because their pages continue here. Empty if none.
  std::function<std::vector<std::string>()> page_servers;
  TrustedProxies proxies;
  /// Stops the process soon. If empty, a request cannot stop it.
  std::function<void()> request_stop;
};

}  // namespace kerf::net
