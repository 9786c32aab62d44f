// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/session/session_registry.h"

namespace kerf::net {

/// The UDP lane that agents may ask for.
struct UdpOptions {
  bool on = true;
  /// Named by the user: it must work. Otherwise a port that is taken is a warning.
  bool required = false;
  std::string address;                ///< empty: that of HTTP
  std::optional<std::uint16_t> port;  ///< empty: that of HTTP; 0: the system picks one
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8080;  ///< 0: the system picks one
  std::filesystem::path data_folder = "kerf-data";
  std::filesystem::path web_folder;  ///< of the built viewer; empty: none is served
  std::vector<std::string>
      allow_origins;  ///< besides the server's own host, e.g. "https://kerf.example"
  std::size_t connections_max = 4096;
  std::size_t sessions_max = 64;
  SessionLimits session;
  UdpOptions udp;
};

/// The whole service in one process: registry, lanes, listener.
class Server {
 public:
  /// Prepares the data folder and brings its sessions back; broken journals are logged, not fatal.
  static std::expected<std::unique_ptr<Server>, std::string> create(ServerOptions options);
  ~Server();

  SessionRegistry& sessions();
  /// Starts to listen. The error is one sentence.
  std::expected<void, std::string> listen();
  /// "http://ADDRESS:PORT" with the port that is really bound.
  std::string url() const;
  std::uint16_t port() const;
  /// 0 if there is no UDP lane.
  std::uint16_t udp_port() const;
  /// Says bye to everybody, commits the journals, stops. Called by the destructor too.
  void stop();

 private:
  struct Impl;
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf::net
