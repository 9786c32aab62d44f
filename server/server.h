// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/cluster/cluster_node.h"
#include "server/cluster/replication.h"
#include "server/http/http_options.h"
#include "server/session/session_registry.h"

namespace kerf::net {

/// The UDP port that agents may use in addition to their WebSocket.
struct UdpOptions {
  bool on = true;
  /// Failing to bind is an error instead of a warning; set if the user chose the port.
  bool required = false;
  std::string address;                ///< empty: address of HTTP
  std::optional<std::uint16_t> port;  ///< empty: port of HTTP; 0: the system chooses one
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8080;  ///< 0: the system chooses one
  HttpOptions http;
  std::size_t connections_max = 4096;
  std::size_t sessions_max = 64;
  SessionLimits session;
  SnapshotLimits snapshots;
  DiskLimits disk;
  UdpOptions udp;
  std::string admin_token;  ///< empty: no administrator; only its hash is kept
  bool open = false;        ///< callers without a token are guests
  /// Address of the server that continues the sessions after this one has stopped; may be empty.
  std::string drain_to;
  ReplicationOptions copies;
  ClusterOptions cluster;
  /// Upper limit of every viewer's mesh frames, bytes per second (0: unlimited).
  std::uint32_t viewer_budget = 0;
  bool needs_copy = false;  ///< samples are durable only when they are copied too
  /// PEM files of the certificate and its key; both empty: no TLS.
  std::filesystem::path tls_certificate, tls_key;
};

/// The complete service in one process: session registry, threads and listeners.
class Server {
 public:
  /// Creates the data folder if needed, locks it, and starts to load its sessions on threads of
  /// their own. A damaged journal is logged and skipped. Fails if another server uses the folder.
  static std::expected<std::unique_ptr<Server>, std::string> create(ServerOptions options);
  ~Server();

  SessionRegistry& sessions();
  /// Starts listening. The error is one sentence.
  std::expected<void, std::string> listen();
  /// Returns "http://ADDRESS:PORT", or "https://" with TLS, with the bound port; "localhost" for a
  /// server on all addresses.
  std::string url() const;
  std::uint16_t port() const;
  /// Returns the bound UDP port, or 0 if UDP is off.
  std::uint16_t udp_port() const;
  /// Reads the certificate again, for new connections. The previous one stays if it cannot be used.
  /// The error is one sentence.
  std::expected<void, std::string> reload_certificate();
  /// Sends `bye` to all peers, with the address of the server that continues, commits the journals
  /// and stops. Also called by the destructor.
  void stop();

 private:
  struct Impl;
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf::net
