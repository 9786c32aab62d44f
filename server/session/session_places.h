// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/store/write_fence.h"

namespace kerf {

/// A session that another server of the cluster runs, as of that server's last statement.
struct PlacedSession {
  std::string id, name, node;
  std::string address;  ///< of that server, "http://HOST:PORT"
  std::uint64_t motions = 0;
  double removed_mm3 = 0;
  std::size_t participants = 0;
  std::int64_t created_ms = 0, active_ms = 0;  ///< as in SessionFigures
};

/// Assigns the sessions of a cluster to its servers: one runs each session at a time. Thread-safe.
class SessionPlaces {
 public:
  virtual ~SessionPlaces() = default;

  /// Claims a session that this server creates or, with `is_known`, reopens. The error, one
  /// sentence, names its owner or says that the cluster cannot be reached. Blocks until the answer.
  virtual std::expected<void, std::string> claim(const std::string& id, bool is_known) = 0;
  /// Whether a session with this id is known to run somewhere.
  virtual bool is_taken(const std::string& id) const = 0;
  /// The time limit for changes by this server to a session that it has claimed.
  virtual std::shared_ptr<const WriteFence> fence(const std::string& id) const = 0;
  /// The epoch in which this server may run a session: greater than that of any earlier owner.
  virtual std::uint32_t epoch(const std::string& id) const = 0;
  /// States that a session of this server has ended, so that nobody continues it. After an error,
  /// one sentence, this server still has the session. Blocks until the answer.
  virtual std::expected<void, std::string> close(const std::string& id) = 0;
  /// Gives up the claim of a session that could not be started.
  virtual void give_up(const std::string& id) = 0;

  /// The name of this server.
  virtual const std::string& node() const = 0;
  /// The sessions of the other servers.
  virtual std::vector<PlacedSession> elsewhere() const = 0;
  /// The address of the other server that runs the session now; nullopt if none is known to.
  virtual std::optional<std::string> address_of(const std::string& id) const = 0;
  /// Whether nobody runs the session now, but a server is expected to continue it soon.
  virtual bool is_moving(const std::string& id) const = 0;
  /// The name of the lost server that alone can continue the session, because its journal was not
  /// copied; nullopt for other sessions. Known once a server has tried to take the session over.
  virtual std::optional<std::string> needed_server(const std::string& id) const = 0;
  /// The addresses of the other servers, which may continue this server's sessions.
  virtual std::vector<std::string> other_servers() const = 0;
  /// Returns the address of the server with the fewest sessions if it has fewer than this one, and
  /// counts the new session for it. Nullopt: create the session here.
  virtual std::optional<std::string> place_for_new() = 0;
  /// Asks this server to follow another server's session for viewers. Returns whether it does or
  /// soon will; find_followed() then returns the session.
  virtual bool wants_to_follow(const std::string& id) = 0;
};

}  // namespace kerf
