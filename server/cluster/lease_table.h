// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/cluster/lease.h"
#include "server/session/session_places.h"

namespace kerf {

/// Time for which pages of a lost server may use the other servers, ns: a day.
inline constexpr std::int64_t kPageLifeNs = 86'400'000'000'000;

/// A lease as last seen.
struct SeenLease {
  Lease lease;
  std::uint64_t revision = 0;
  std::int64_t since_ns = 0;  ///< when this server first saw this revision, by its own clock
  bool needs_owner = false;   ///< the owner is lost, and nobody else has the journal
};

/// Another server and its number of sessions.
struct OtherServer {
  std::string name, address;
  std::size_t sessions = 0;
  bool only_follows = false;
};

/// The leases and servers that one server has seen. Has no clock: times are ns of Clock::boot_ns().
/// Does not know which leases this server holds. Not thread-safe.
class LeaseTable {
 public:
  /// `node` and `run` are this server's.
  LeaseTable(std::string node, std::string run) : node_(std::move(node)), run_(std::move(run)) {}

  /// Notes a lease. A known revision changes nothing. A smaller one comes from a NATS that has lost
  /// some.
  void note(const std::string& session, Lease lease, std::uint64_t revision, std::int64_t now_ns);
  /// Corrects a lease whose state at NATS differs from the known one, for example after NATS was
  /// restored from an earlier store. The lease counts as renewed now, because its owner may have
  /// renewed it until NATS was lost. The epoch stays the largest one seen.
  void correct(const std::string& session, const StoredLease& stored, std::int64_t now_ns);
  void note(const std::string& node, NodeNote note, std::int64_t now_ns);
  /// This revision of the lease could be taken, but only its lost owner has the journal. In effect
  /// until the lease changes.
  void note_uncopied(const std::string& session, std::uint64_t revision);
  /// The watch began at `now_ns`, so no lease counts as older.
  void begin(std::int64_t now_ns) { began_ns_ = now_ns; }

  const SeenLease* find(const std::string& session) const;
  /// Returns the leases that may be taken now: unchanged for their taken_ns(), or released. Those
  /// that name another server are reserved for it for a while.
  std::vector<std::string> takeable(std::int64_t now_ns) const;
  /// Whether a session of another server exists but has no owner now, and another server can
  /// continue it.
  bool is_moving(const std::string& session, std::int64_t now_ns) const;
  /// The name of the lost owner that alone can continue a session (note_uncopied).
  std::optional<std::string> needed_server(const std::string& session) const;
  /// The address of the other server that runs a session now.
  std::optional<std::string> address_of(const std::string& session, std::int64_t now_ns) const;
  /// The sessions that other servers run, or ran last.
  std::vector<PlacedSession> elsewhere() const;
  /// The other servers with a recent announcement.
  std::vector<OtherServer> others(std::int64_t now_ns) const;
  /// The addresses that other servers announced within kPageLifeNs.
  std::vector<std::string> page_servers(std::int64_t now_ns) const;
  /// The other server with the fewest sessions, of those that run sessions, or nullopt without one.
  std::optional<OtherServer> least_loaded(std::int64_t now_ns) const;
  /// Counts one expected session for a server, until it has it or has announced itself twice.
  void expect_session(const std::string& node);

 private:
  struct SeenNode {
    NodeNote note;
    std::int64_t since_ns = 0;
    /// Expected sessions, and those of them that have not arrived since its last announcement.
    std::size_t expected = 0, overdue = 0;
  };
  void note_new(const Lease& lease);
  bool is_own(const SeenLease& seen) const { return seen.lease.run == run_; }
  bool is_fresh(const SeenLease& seen, std::int64_t now_ns) const;

  std::string node_, run_;
  std::int64_t began_ns_ = 0;
  std::map<std::string, SeenLease> leases_;
  std::map<std::string, SeenNode> nodes_;
  std::map<std::string, std::int64_t> pages_;  ///< last announcement of each other address
};

}  // namespace kerf
