// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kerf::net {

struct HttpOptions {
  std::filesystem::path data_folder = "kerf-data";
  std::filesystem::path web_folder;  ///< of the built viewer; empty: no viewer is served
  /// Names, besides IP addresses and localhost, by which clients may address the server.
  std::vector<std::string> allow_hosts;
  std::vector<std::string> allow_origins;  ///< besides the server's own host, e.g.
                                           ///< "https://kerf.example"
};

}  // namespace kerf::net
