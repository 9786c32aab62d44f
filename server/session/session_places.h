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

/// A session that another server of the cluster runs, as it has stated last.
struct PlacedSession {
  std::string id, name, node;
  std::string address;  ///< of that server, "http://HOST:PORT"
  std::uint64_t motions = 0;
  double removed_mm3 = 0;
  std::size_t participants = 0;
  std::int64_t created_ms = 0, active_ms = 0;  ///< as in SessionFigures
};

/// How the servers of a cluster share sessions: each is run by one of them at a time.
/// Thread-safe.
class SessionPlaces {
 public:
  virtual ~SessionPlaces() = default;

  /// Takes a session that this server creates, or, with `is_known`, opens again. The error, one
  /// sentence, says who has it, or that nobody can be asked. Waits for an answer.
  virtual std::expected<void, std::string> claim(const std::string& id, bool is_known) = 0;
  /// Whether a session of this id runs somewhere, as far as this server knows.
  virtual bool is_taken(const std::string& id) const = 0;
  /// Until when this server may change the session, which it has claimed.
  virtual std::shared_ptr<const WriteFence> fence(const std::string& id) const = 0;
  /// The epoch in which this server may run it: greater than that of any server before.
  virtual std::uint32_t epoch(const std::string& id) const = 0;
  /// The session has been closed, or could not be started: nobody runs it.
  virtual void close(const std::string& id) = 0;

  /// The name of this server.
  virtual const std::string& node() const = 0;
  /// The sessions of the other servers.
  virtual std::vector<PlacedSession> elsewhere() const = 0;
  /// The address of the other server that runs the session now; nullopt: none is known to.
  virtual std::optional<std::string> address_of(const std::string& id) const = 0;
  /// Whether a server is expected to continue the session soon: nobody runs it now.
  virtual bool is_moving(const std::string& id) const = 0;
  /// The addresses of the other servers, which may continue the sessions of this one.
  virtual std::vector<std::string> other_servers() const = 0;
  /// The address of the server that has fewer sessions than any other and than this one, and which
  /// is now thought to get one more; nullopt: a new session belongs here.
  virtual std::optional<std::string> place_for_new() = 0;
  /// Asks this server to follow a session of another one, for viewers. Whether it does, or will
  /// soon: the registry has it then (find_followed()).
  virtual bool wants_to_follow(const std::string& id) = 0;
};

}  // namespace kerf
