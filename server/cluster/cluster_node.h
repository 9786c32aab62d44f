// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/cluster/followers.h"
#include "server/cluster/lease.h"
#include "server/session/session_places.h"
#include "server/session/session_registry.h"

namespace kerf {

struct ClusterOptions {
  std::string node;  ///< unique name of this server; empty: not in a cluster
  std::string
      advertise;  ///< its address for clients, "http://HOST:PORT"; empty: that of the server
  Follow follow = Follow::kNone;  ///< sessions of other servers
  /// Time for which the server may change a session after it sent the last stored renewal:
  /// LeaseTime.
  std::int64_t lease_ms = LeaseTime{}.writes_ns / 1'000'000;
};

/// One of several servers that share sessions by leases at NATS. It renews the leases of its own
/// sessions, takes those of servers that are gone or have stopped, and knows where each session is.
class ClusterNode final : public SessionPlaces {
 public:
  /// The error is one sentence: a bad URL, or a program without libnats. A server that is away is
  /// no error.
  static std::expected<std::unique_ptr<ClusterNode>, std::string> connect(const std::string& url,
                                                                          int replicas,
                                                                          std::string node);
  ~ClusterNode() override;

  /// Joins the cluster as the server at `address`, and claims sessions of the data folder that have
  /// no owner. The registry must outlive hold(). `report` is called, on any thread, with the result
  /// of opening a session.
  void start(SessionRegistry& registry, std::string address, const ClusterOptions& options,
             std::function<void(const LoadReport&)> report);
  /// Takes no more sessions, and announces that its sessions will move. Returns the address of the
  /// server that should take them, or empty if there is none.
  std::string hold();
  /// Releases the leases except those of `unfinished`, whose copies are incomplete: these expire.
  /// Then leaves the cluster. Call after hold(), when the sessions have ended.
  void release(const std::vector<std::string>& unfinished);

  std::expected<void, std::string> claim(const std::string& id, bool is_known) override;
  bool is_taken(const std::string& id) const override;
  std::shared_ptr<const WriteFence> fence(const std::string& id) const override;
  std::uint32_t epoch(const std::string& id) const override;
  std::expected<void, std::string> close(const std::string& id) override;
  void give_up(const std::string& id) override;
  const std::string& node() const override;
  std::vector<PlacedSession> elsewhere() const override;
  std::optional<std::string> address_of(const std::string& id) const override;
  bool is_moving(const std::string& id) const override;
  std::optional<std::string> needed_server(const std::string& id) const override;
  std::vector<std::string> other_servers() const override;
  /// The addresses of the other servers whose pages may still be open: those that announced
  /// themselves within kPageLifeNs (lease_table.h), even if they are gone.
  std::vector<std::string> page_servers() const;
  std::optional<std::string> place_for_new() override;
  bool wants_to_follow(const std::string& id) override;

 private:
  struct Impl;
  explicit ClusterNode(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
